// SPDX-License-Identifier: MIT
// Ranks of the lattice engine over MPI.
#pragma once

#include <mpi.h>

#include <chrono>

#include "emu/lattice/ranks.h"

namespace cuboct::emu {

// The ranks of MPI_COMM_WORLD; MPI is initialised here and finalised in the end. A call that MPI refuses
// throws std::runtime_error ("MPI_Isend failed in rank 1: MPI_ERR_...").
class MpiRanks : public Ranks {
 public:
  MpiRanks(int* argc, char*** argv);
  ~MpiRanks() override;
  MpiRanks(const MpiRanks&) = delete;
  MpiRanks& operator=(const MpiRanks&) = delete;

  int rank() const override { return rank_; }
  int size() const override { return size_; }
  void sum(std::span<uint64_t> values) override;
  void most(std::span<double> values) override;
  void any(std::span<uint8_t> flags) override;
  std::vector<Bytes> exchange(const std::vector<Bytes>& to) override;
  Bytes all(const Bytes& mine) override;
  void start(const std::vector<std::span<const double>>& to,
             const std::vector<std::span<double>>& from) override;
  void finish() override;
  void give_up(int code) override;

 private:
  // Until all are done.
  void wait(std::span<MPI_Request> requests) const;

  int rank_ = 0, size_ = 1;
  std::chrono::nanoseconds spin_{};  // of a wait, before it sleeps
  std::vector<MPI_Request> requests_;
};

}  // namespace cuboct::emu
