// SPDX-License-Identifier: MIT
#include "cli/study/multiscale_node.h"

#include <fmt/format.h>

#include "cli/machine/clock_option.h"
#include "cli/machine/technologies.h"
#include "model/base/error.h"
#include "model/base/output.h"

namespace cuboct {
namespace {

std::string share(uint64_t count, uint64_t atoms) {
  return fmt::format("{:.4g}", static_cast<double>(count) / static_cast<double>(atoms));
}

void add_technology(Items& items, const NodeFindings& found, const Technology& technology) {
  const SampleNode& node = found.node;
  const Energy energy = energy_of(node, found.clock, technology);
  const Band area = area_of(node, technology);
  const std::string name = "node " + technology.name;
  if (energy.rows.empty()) {
    items.add(name, "no figure", "every term is missing");
    return;
  }
  items.add(name + " least", energy.sum.low / node.atom_steps(), "pJ",
            fmt::format("of an atom-step; {} terms are missing", energy.missing.size()));
  items.add(name + " most", energy.sum.high / node.atom_steps(), "pJ",
            fmt::format("{:.3g} to {:.3g} nJ a relaxation", energy.sum.low / 1e3, energy.sum.high / 1e3));
  if (area.high > 0)
    items.add(name + " area", area.high, "mm^2",
              fmt::format("{:.3g} to {:.3g}; without control", area.low, area.high));
}

}  // namespace

NodeFindings node_of(const ElementStudy& study, const SampleMaterial& material, int fraction,
                     const std::string& clock, const std::vector<std::string>& technologies) {
  if (!study.material.tersoff)
    throw InputError("--technology: a node is counted for Tersoff's potential alone",
                     "leave it out, or give 'potential', 'file' or 'parameters' in [material]");
  NodeFindings out;
  out.clock = clock_of(clock);
  for (const std::string& name : technologies) out.technologies.push_back(technology_named(name));
  out.node = count_sample_node(material, *study.material.tersoff, {.fraction = fraction});
  return out;
}

void add_node(Items& items, const NodeFindings& found) {
  const SampleNode& node = found.node;
  const OperationCounts each = node.evaluation();
  items.add("node width", node.width, "bits", fmt::format("{} behind the point", node.fraction));
  items.add("node force error", node.force_error, "",
            "of the largest force, atoms shaken by 0.02 angstrom, beside doubles");
  items.add("node stress error", node.stress_error, "", "of the stress of a strain of 0.001, at rest");
  items.add("node operations",
            share(each.products, node.atoms) + " products, " + share(each.adds, node.atoms) + " sums, " +
                share(each.lookups, node.atoms) + " reads of tables",
            "of an atom-step");
  items.add("node evaluations", node.evaluations, "", "of a relaxation from the lattice");
  items.add("node cycles", node.cycles(), "",
            fmt::format("of the relaxation, {:.4g} of an evaluation; {:.3g} atom-steps a second",
                        node.cycles_of_evaluation(), node.atom_steps() / node.cycles() * found.clock));
  for (const Technology& technology : found.technologies) add_technology(items, found, technology);
}

void write_node(const NodeFindings& found, const std::string& directory) {
  const double steps = found.node.atom_steps();
  std::string text = "technology\tterm\tevents_per_atom_step\tof\tpJ_least\tpJ_most\tsource\n";
  for (const Technology& technology : found.technologies) {
    const Energy energy = energy_of(found.node, found.clock, technology);
    for (const EnergyRow& row : energy.rows)
      text += fmt::format("{}\t{}\t{:.6g}\t{}\t{:.6g}\t{:.6g}\t{}\n", technology.name, row.term,
                          row.events / steps, row.of, row.picojoules.low / steps, row.picojoules.high / steps,
                          row.source);
    for (const std::string& missing : energy.missing)
      text += fmt::format("{}\t{}\t\t\t\t\tmissing\n", technology.name, missing);
  }
  write_text(directory + "/node.tsv", text);
}

}  // namespace cuboct
