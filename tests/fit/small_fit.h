// SPDX-License-Identifier: MIT
// A fit of seconds: the bar of scenes/studies/fit_bar.toml, pulled to 6 % in twelve load steps, and a curve
// that a known law makes of it.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "study/law_fit/fit.h"
#include "tests/support/folder.h"

namespace cuboct::fit::test {

class SmallFit : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder_.path(name); }
  // `target`: of [target]; `search`: of [search].
  std::string study(const std::string& target, const std::string& search,
                    const std::string& name = "study.toml") const {
    std::ofstream(path(name)) << "scene = \"" CUBOCT_SOURCE_DIR "/scenes/studies/fit_bar_scene.toml\"\n"
                              << "reach = 1.4142135\n[change.run]\nduration = \"0.8 ms\"\n"
                              << "static = { load_steps = 12, evaluations = 500 }\n[target]\n"
                              << target << "[search]\n"
                              << search;
    return path(name);
  }
  // Of the law that is to be found: it bends over early, and differs from where searches begin.
  static Parameters made_by(const FitStudy& study) {
    Parameters p = study.start;
    p[stiffness] = 1.3, p[pull_1] = 0.5, p[pull_2_force] = 0.7, p[pull_3_force] = 1.4;
    return p;
  }
  // Its curve, as a file.
  std::string data() const {
    const FitStudy rough =
        read_fit(study("strain = [0, 0.01, 0.06]\nstress = \"[0, 30, 60] MPa\"\n", "", "rough.toml"));
    const Tested made = run_test(rough.test, points_of(draw(made_by(rough), rough.scale)));
    std::ofstream file(path("made.csv"));
    file << "strain,stress (Pa)\n0,0\n";
    for (size_t k = 1; k < made.strain.size(); ++k) file << made.strain[k] << ',' << made.stress[k] << '\n';
    return "file = \"made.csv\"\n";
  }
  Fit fit(const FitStudy& study, Evaluations& evaluations) const {
    FitOptions options;
    options.progress = false;
    return run_fit(study, evaluations, options);
  }
  std::string directory(const std::string& name) const {
    std::filesystem::create_directory(path(name));
    return path(name);
  }

 private:
  cuboct::test::Folder folder_;
};

}  // namespace cuboct::fit::test
