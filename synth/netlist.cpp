// SPDX-License-Identifier: MIT
#include "synth/netlist.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <stdexcept>
#include <unordered_map>

#include "synth/json_file.h"

namespace cuboct::synth {
namespace {

using nlohmann::json;

// One instance of the elaborated design.
struct Node {
  std::string module;
  Counts own;
  std::vector<size_t> children;
};

class Tree {
 public:
  Tree(const Design& design, const std::string& root) { grow(design, root, ""); }

  // The deepest instance of which `cell` has the path.
  Counts& at(std::string cell) {
    // Passes that did not name a cell after a net leave the path behind the first backslash.
    if (cell.starts_with('$')) {
      const size_t path = cell.find('\\');
      cell = path == std::string::npos ? "" : cell.substr(path + 1);
      cell.erase(std::remove(cell.begin(), cell.end(), '\\'), cell.end());
    }
    for (size_t dot = cell.size(); dot != std::string::npos && dot > 0; dot = cell.rfind('.', dot - 1))
      if (const auto found = by_path_.find(cell.substr(0, dot)); found != by_path_.end())
        return nodes_[found->second].own;
    return nodes_[0].own;
  }

  Block block() const { return merged({0}); }

 private:
  void grow(const Design& design, const std::string& key, const std::string& path) {
    const size_t here = nodes_.size();
    by_path_[path] = here;
    const Module& module = design.modules.at(key);
    nodes_.push_back({module.base, {}, {}});
    for (const auto& [name, child] : module.instances) {
      nodes_[here].children.push_back(nodes_.size());
      grow(design, child, path.empty() ? name : path + "." + name);
    }
  }

  Block merged(const std::vector<size_t>& same) const {
    Block block{nodes_[same[0]].module, same.size(), {}, {}};
    std::map<std::string, std::vector<size_t>> by_module;
    for (const size_t n : same) {
      block.counts += nodes_[n].own;
      for (const size_t child : nodes_[n].children) by_module[nodes_[child].module].push_back(child);
    }
    for (const auto& [module, nodes] : by_module) {
      block.children.push_back(merged(nodes));
      block.counts += block.children.back().counts;
    }
    return block;
  }

  std::vector<Node> nodes_;
  std::unordered_map<std::string, size_t> by_path_;
};

// Calls `found(path, counts)` for each cell below `module`, the paths of kept modules joined.
void walk(const json& modules, const std::string& module, const std::string& path, const CostOf& cost_of,
          const std::function<void(const std::string&, const Counts&)>& found, int depth = 0) {
  if (depth > kDeepest) throw std::runtime_error(fmt::format("the module {} lies within itself", module));
  for (const auto& [cell, what] : modules.at(module).at("cells").items()) {
    const std::string& type = what.at("type").get_ref<const std::string&>();
    const std::string name = path.empty() ? cell : fmt::format("{}.{}", path, cell);
    if (const auto cost = cost_of(type)) {
      found(name, *cost);
    } else if (modules.contains(type) && !modules.at(type).at("attributes").contains("blackbox")) {
      walk(modules, type, name, cost_of, found, depth + 1);
    } else if (type != "$scopeinfo") {
      throw std::runtime_error(fmt::format("the netlist has a cell of an unknown kind, {}", type));
    }
  }
}

}  // namespace

Block read_netlist(const std::string& file, const std::string& netlist_module, const Design& design,
                   const std::string& root, const CostOf& cost_of) {
  Tree tree(design, root);
  read_netlist_json(file, [&](const json& netlist) {
    walk(netlist.at("modules"), netlist_module, "", cost_of,
         [&](const std::string& path, const Counts& counts) { tree.at(path) += counts; });
  });
  return tree.block();
}

Counts count_all(const std::string& file, const std::string& top, const CostOf& cost_of) {
  Counts all;
  read_netlist_json(file, [&](const json& netlist) {
    walk(netlist.at("modules"), top, "", cost_of,
         [&](const std::string&, const Counts& counts) { all += counts; });
  });
  return all;
}

}  // namespace cuboct::synth
