// SPDX-License-Identifier: MIT
// The choice of vectors is the process's. Neighbour lists of the real engine are made for vectors of one
// width and summed by those chosen later: while threads run both engines, nobody may change the choice.
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <atomic>
#include <string>
#include <thread>

#include "emu/lattice/kernel.h"
#include "emu/lattice/kernel_rule.h"
#include "model/real/pair_kernel.h"
#include "tests/support/cases.h"

namespace cuboct::test {
namespace {

struct LatticeKernels : testing::Test {
  const Case c = make_case("damped");
  const emu::KernelRule rule = emu::kernel_rule(c.setup.plan.rule, c.setup.plan.arch.capacity);
  const int64_t all = hwy::SupportedTargets();
  void SetUp() override {
    ASSERT_TRUE(rule.fits);
    emu::kernels_here(rule);  // the first may look what the machine has
    if ((all & (all - 1)) == 0) GTEST_SKIP() << "this machine has one instruction set only";
  }
};

TEST_F(LatticeKernels, LeaveTheChoiceOfVectorsAsItIs) {
  for (int64_t left = all; left != 0; left &= left - 1) {
    hwy::GetChosenTarget().Update(left);
    const std::string before = pair_simd();
    emu::kernels_here(rule);
    EXPECT_EQ(pair_simd(), before);
  }
  hwy::GetChosenTarget().Update(all);
}

TEST_F(LatticeKernels, ChangeItForNoOtherThread) {
  const size_t lanes = pair_lanes<double>();
  std::atomic<bool> done = false;
  std::thread other([&] {
    for (int k = 0; k < 1000; ++k) emu::kernels_here(rule);
    done = true;
  });
  size_t looks = 0, changed = 0;
  do {
    ++looks;
    changed += pair_lanes<double>() != lanes;
  } while (!done);
  other.join();
  EXPECT_EQ(changed, 0u) << "of " << looks;
}

}  // namespace
}  // namespace cuboct::test
