// SPDX-License-Identifier: MIT
// What a fit of Tersoff's parameters found, as items, files and a picture.
#pragma once

#include <string>
#include <vector>

#include "cli/items.h"
#include "study/potential_fit/bond_fit.h"

namespace cuboct {

struct BondFindings {
  const bond_fit::BondStudy& study;
  const bond_fit::BondFit& fit;
  const std::vector<bond_fit::Compared>& compared;
  double seconds;  // that this command took
};

// Without a stable set only what was tried.
Items items_of(const BondFindings& found);
// sets.tsv: every start; trials.tsv: what was tried in time.
void write_bond_tables(const BondFindings& found, const std::string& directory);
// The best set, as LAMMPS's pair_style tersoff and [material] of a multiscale study take it.
std::string potential_file(const bond_fit::BondStudy& study, const bond_fit::BondFit& fit);
// convergence.tsv, and convergence.png by gnuplot: InputError where that is not there.
void write_convergence(const BondFindings& found, const std::string& directory);
void draw_convergence(const BondFindings& found, const std::string& directory);

}  // namespace cuboct
