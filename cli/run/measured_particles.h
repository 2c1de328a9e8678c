// SPDX-License-Identifier: MIT
// What a measure says of each particle, as a file: comma-separated values, or frames of viewers with it as a
// column.
#pragma once

#include <memory>
#include <string>

#include "cli/run/measure_run.h"

namespace cuboct {

class ParticlesFile {
 public:
  // Of its name's ending: .csv; .xyz, .xyz.gz (extended XYZ), .dump.gz (LAMMPS), .pvd (VTK), with all columns
  // of docs/reference/frames.md. InputError where the ending is another, or the file cannot be written.
  ParticlesFile(const std::string& path, const Loaded& loaded);
  ~ParticlesFile();  // without finish() a file that was there before stays; of .pvd it goes
  ParticlesFile(const ParticlesFile&) = delete;
  ParticlesFile& operator=(const ParticlesFile&) = delete;

  void add(const KeptFrame& kept, const Snapshot& now, const MeasuredParticles& particles);
  void finish();

  class Form;

 private:
  std::string path_, temporary_;  // that the form writes, until it is whole; empty of .pvd
  const Loaded& loaded_;
  std::unique_ptr<Form> form_;
  bool finished_ = false;
};

}  // namespace cuboct
