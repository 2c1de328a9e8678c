// SPDX-License-Identifier: MIT
#include "study/machines/machine_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "model/base/error_parts.h"
#include "model/base/hash.h"
#include "model/config/file_kind.h"
#include "study/sweep/axes.h"
#include "study/sweep/study_frame.h"

namespace cuboct::study {
namespace {

constexpr double kMostPoints = 100'000;  // of a grid
constexpr Dimension kFrequency{{0, 0, -1}};

// A clock is of the machine: it has its unit in studies in reduced units too.
double clock_of(const ConfigValue& at) {
  constexpr double kLeast = 1, kMost = 1e12;
  constexpr const char* kExample = "such as \"100 MHz\"";
  try {
    const ParsedQuantity q = parse_quantity(at.string());
    if (q.list || q.dimension != kFrequency)
      at.fail(fmt::format("'{}' is not a frequency", at.string()), kExample);
    if (!(q.values[0] >= kLeast && q.values[0] <= kMost))
      at.fail(fmt::format("'{}' is not in [1 Hz, 1 THz]", at.string()), kExample);
    return q.values[0];
  } catch (const UnitError& error) {
    at.fail(fmt::format("'{}' is not a frequency: {}", at.string(), error.message), kExample);
  }
}

std::vector<ConfigValue> items_of(const ConfigValue& value) {
  std::vector<ConfigValue> items = value.is_array() ? value.items() : std::vector{value};
  if (items.empty()) value.fail(fmt::format("'{}' lists nothing", value.key()));
  return items;
}

// What a name cannot give is told where the name stands.
template <typename Work>
auto placed(const ConfigValue& at, Work work) {
  try {
    return work();
  } catch (const InputError& error) {
    const ErrorParts parts = parts_of(error);
    at.fail(parts.message, parts.hint);
  }
}

using SetChoice = std::function<void(MachineChoice&)>;
struct ChoiceAxis {
  std::string name;
  std::vector<SetChoice> sets;
};

class Reader {
 public:
  Reader(MachineStudy& study, const MachineNames& names) : study_(study), names_(names) {}

  // The axes of a grid or a search: scene, technology, clock, target, then those of the settings.
  std::vector<ChoiceAxis> axes(const ConfigTable& table) {
    std::vector<ChoiceAxis> axes;
    size_t scene = 0;
    if (const auto at = table.find("scene")) {
      axes.push_back(scenes(*at));
      MachineChoice first;
      axes.back().sets[0](first);
      scene = first.scene;
    }
    axes.push_back(technologies(table));
    if (const auto at = table.find("clock")) {
      ChoiceAxis axis{"clock", {}};
      for (const ConfigValue& item : items_of(*at))
        axis.sets.push_back([clock = clock_of(item)](MachineChoice& c) { c.clock = clock; });
      axes.push_back(std::move(axis));
    }
    if (const auto at = table.find("target")) {
      ChoiceAxis axis{"target", {}};
      for (const ConfigValue& item : items_of(*at))
        axis.sets.push_back([target = names_.targets[item.choice("device", names_.targets)]](
                                MachineChoice& c) { c.target = target; });
      axes.push_back(std::move(axis));
    }
    for (const Axis& axis : read_axes(table, study_.scenes[scene], KeysOf::machines)) {
      ChoiceAxis mine{axis.name, {}};
      for (const auto& set : axis.sets) mine.sets.push_back([set](MachineChoice& c) { set(c.settings); });
      axes.push_back(std::move(mine));
    }
    return axes;
  }

 private:
  ChoiceAxis scenes(const ConfigValue& at) {
    ChoiceAxis axis{"scene", {}};
    for (const ConfigValue& item : items_of(at))
      axis.sets.push_back([n = scene_at(item)](MachineChoice& c) { c.scene = n; });
    return axis;
  }

  size_t scene_at(const ConfigValue& at) {
    const std::string path = std::filesystem::path(at.file()).lexically_normal().string();
    for (size_t k = 0; k < study_.scenes.size(); ++k)
      if (study_.scenes[k].scene_path == path) return k;
    const Base& base = study_.scenes[0];
    study_.scenes.push_back(read_base(path, base.arch_path));
    study_.scenes.back().arch_text = base.arch_text;
    return study_.scenes.size() - 1;
  }

  // Each technology with each kind of link; without the key the first published ones.
  ChoiceAxis technologies(const ConfigTable& table) {
    std::vector<std::pair<std::string, Technology>> all;
    if (const auto at = table.find("technology"))
      for (const ConfigValue& item : items_of(*at))
        all.emplace_back(item.string(), placed(item, [&] { return names_.technology(item.string()); }));
    else
      for (const char* name : {"cmos45", "cmos7"}) all.emplace_back(name, names_.technology(name));
    ChoiceAxis axis{"technology", {}};
    const auto add = [&](const Technology& technology, const std::string& name) {
      const auto found = std::ranges::find(study_.technologies, name, &Technology::name);
      const auto n = static_cast<size_t>(found - study_.technologies.begin());
      if (found == study_.technologies.end()) {
        study_.technologies.push_back(technology);
        study_.technologies.back().name = name;
      }
      axis.sets.push_back([n](MachineChoice& c) { c.technology = n; });
    };
    const auto links = table.find("link");
    for (const auto& [name, technology] : all) {
      if (!links) add(technology, technology.name);
      if (links)
        for (const ConfigValue& item : items_of(*links))
          add(placed(item, [&, &t = technology] { return names_.linked(t, item.string()); }),
              fmt::format("{}, {} links", technology.name, item.string()));
    }
    return axis;
  }

  MachineStudy& study_;
  const MachineNames& names_;
};

std::string key_of(const MachineChoice& c) {
  return fmt::format("{} {} {} {}", c.machine_key(), c.clock, c.technology, c.target);
}

void read_grids(const ConfigTable& root, Reader& reader, MachineStudy& study) {
  std::set<std::string> known;
  for (const ConfigTable& table : root.tables("machines")) {
    const std::vector<ChoiceAxis> axes = reader.axes(table);
    double count = 1;
    for (const ChoiceAxis& axis : axes) count *= static_cast<double>(axis.sets.size());
    if (count > kMostPoints)
      table.fail(fmt::format("this grid has {:.3g} points: at most {:.0f} are taken", count, kMostPoints),
                 "[evolve] searches large spaces");
    std::vector<size_t> at(axes.size(), 0);
    for (bool more = true; more;) {
      MachineChoice choice;
      for (size_t k = 0; k < axes.size(); ++k) axes[k].sets[at[k]](choice);
      if (known.insert(key_of(choice)).second) study.points.push_back(std::move(choice));
      size_t k = axes.size();
      while (k > 0 && ++at[k - 1] == axes[k - 1].sets.size()) at[--k] = 0;
      more = k > 0;
    }
  }
}

void read_evolution(const ConfigTable& table, Reader& reader, MachineStudy& study) {
  MachineEvolution evolution;
  evolution.population = static_cast<int>(table.integer_or("population", 8, 1000, evolution.population));
  evolution.generations = static_cast<int>(table.integer_or("generations", 1, 10'000, evolution.generations));
  evolution.seed = static_cast<unsigned>(table.integer_or("seed", 0, 1'000'000, evolution.seed));
  // pagmo draws parents in fours.
  if (evolution.population % 4 != 0)
    table.at("population")
        .fail("a population is a multiple of 4",
              fmt::format("population = {}", (evolution.population / 4 + 1) * 4));
  for (ChoiceAxis& axis : reader.axes(table)) {
    MachineSpace& space = evolution.space;
    space.names.push_back(axis.name);
    space.sizes.push_back(axis.sets.size());
    space.first.push_back(space.set.size());
    for (SetChoice& set : axis.sets) space.set.push_back(std::move(set));
  }
  study.evolution = std::move(evolution);
}

uint64_t hash_of(const MachineStudy& study) {
  Hash hash;
  const auto text = [&](const std::string& t) {
    hash.add(static_cast<int64_t>(t.size()));
    for (const char c : t) hash.add(c);
  };
  text(study.scenes[0].scene_text);
  text(study.scenes[0].arch_text);
  text(fmt::format("{}", study.steps));
  return hash.value();
}

}  // namespace

std::string MachineChoice::machine_key() const {
  std::string key = fmt::format("{}", scene);
  for (const Change& change : settings.scene) key += fmt::format(" {}={}", change.key, change.value);
  for (const Change& change : settings.arch) key += fmt::format(" arch.{}={}", change.key, change.value);
  return key;
}

MachineChoice MachineSpace::at(const std::vector<size_t>& notches) const {
  MachineChoice choice;
  for (size_t k = 0; k < notches.size(); ++k) set[first[k] + notches[k]](choice);
  return choice;
}

double MachineSpace::points() const {
  double count = 1;
  for (const size_t size : sizes) count *= static_cast<double>(size);
  return count;
}

std::vector<std::string> MachineStudy::figure_names() const {
  std::vector<std::string> names;
  for (const Figure& figure : frame.figures) names.push_back(figure.name);
  return names;
}

bool is_machine_study(const std::string& path) {
  const ConfigTable root = read_config(path);
  return root.has("machines") || root.has("evolve");
}

namespace {

MachineStudy machine_study_of(const ConfigTable& root, const std::string& path, const MachineNames& names) {
  MachineStudy study;
  for (const char* key : {"sweep", "search"})
    if (const auto other = root.find(key))
      other->fail(fmt::format("a study of machines has no '{}'", key), "its grids are [[machines]]");
  study.frame = read_study_frame(root, path);
  study.scenes = {study.frame.base};
  study.steps =
      static_cast<uint64_t>(root.integer_or("steps", 1, 1'000'000, static_cast<int64_t>(study.steps)));
  study.constraints = read_constraints(root, study.figure_names(), names.targets);
  study.minimise = read_objectives(root, study.figure_names());
  Reader reader(study, names);
  read_grids(root, reader, study);
  if (const auto evolve = root.table_at("evolve")) read_evolution(*evolve, reader, study);
  if (!study.frame.figures.empty() && study.scenes.size() > 1)
    root.at("figure").fail("errors are those of one scene: a study of several has no [[figure]]",
                           "make a study of each scene");
  root.done();
  study.hash = hash_of(study);
  return study;
}

}  // namespace

MachineStudy read_machine_study(const std::string& path, const MachineNames& names) {
  return read_kind(FileKind::machine_study, path,
                   [&](const ConfigTable& root) { return machine_study_of(root, path, names); });
}

}  // namespace cuboct::study
