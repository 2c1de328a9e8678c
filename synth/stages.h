// SPDX-License-Identifier: MIT
// The stages of a flow: what of them is known from before is taken, the rest is made and kept, and each says
// what it found and took.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "synth/input_key.h"
#include "synth/kept_files.h"
#include "synth/tool.h"

namespace cuboct::synth {

class Stages {
 public:
  // `directory`: where the stages leave their files. `names`: those to come, in their order. `tells` gets the
  // lines that stay: of which stages are to be made, before the first, and of each that was.
  Stages(std::string directory, KeptFiles kept, std::vector<std::string> names, Say tells);

  // What may be said of the time of a stage to come: "40 to 90 s". The next line has it.
  void expect(const std::string& name, const std::string& time) { times_[name] = {time, false}; }
  // Of the stage at hand; empty where nothing is known.
  std::string expected() const;

  // Has `work` make files, or takes those that are kept under `key`. All that it adds to the directory is
  // kept once the stage says what it found.
  void make(const std::string& name, const InputKey& key, const std::function<void()>& work);
  // The same of a stage of seconds, which is made each time: nothing is said where it is the only one.
  void make_again(const std::string& name, const std::function<void()>& work);
  // Ends the stage: what it found.
  void found(const std::string& what);

  // Where the stages that were made are kept; empty where nothing is.
  std::string kept() const { return made_ ? kept_.directory() : ""; }

 private:
  void announce(const std::string& first);
  void time(const std::function<void()>& work);

  std::string directory_;
  KeptFiles kept_;
  std::vector<std::string> names_, known_;
  struct Time {
    std::string text;
    bool told = false;
  };
  std::map<std::string, Time> times_;
  struct Pending {
    std::string key;
    std::vector<std::string> files;
  };
  Pending pending_;  // of the stage at hand
  Say tells_;
  bool announced_ = false, made_ = false;
  bool told_ = true;  // what the stage at hand found is not to be said, or was
  std::string name_;  // the stage at hand
  double seconds_ = 0;
};

}  // namespace cuboct::synth
