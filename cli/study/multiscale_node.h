// SPDX-License-Identifier: MIT
// What `cuboct multiscale --technology` tells: a node for each element.
#pragma once

#include <string>
#include <vector>

#include "cli/items.h"
#include "model/atoms/multiscale/element_study.h"
#include "study/sample_node/sample_node.h"

namespace cuboct {

struct NodeFindings {
  SampleNode node;
  double clock = 0;  // Hz
  std::vector<Technology> technologies;
};

// InputError where the study's law is not Tersoff's.
NodeFindings node_of(const ElementStudy& study, const SampleMaterial& material, int fraction,
                     const std::string& clock, const std::vector<std::string>& technologies);
void add_node(Items& items, const NodeFindings& found);
// node.tsv: each term of each technology, and what is missing.
void write_node(const NodeFindings& found, const std::string& directory);

}  // namespace cuboct
