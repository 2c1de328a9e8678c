// SPDX-License-Identifier: MIT
// The code of checked links: published check values, distances by exhaustion, what is certain of a beat.
#include <gtest/gtest.h>

#include <set>
#include <unordered_set>

#include "emu/machine/words.h"
#include "emu/systemc/link_guard.h"
#include "hw/arch/link_code.h"
#include "model/config/config.h"
#include "tests/support/cases.h"
#include "tests/support/dice.h"
#include "tests/support/refused_with.h"

namespace cuboct::test {
namespace {

// "123456789" with the first byte's bit 0 first, or its bit 7.
std::array<uint64_t, 2> digits(bool high_first) {
  std::array<uint64_t, 2> words{};
  for (int k = 0; k < 72; ++k) {
    const int byte = '1' + k / 8, bit = high_first ? 7 - k % 8 : k % 8;
    words[static_cast<size_t>(k / 64)] |= static_cast<uint64_t>(byte >> bit & 1) << (k % 64);
  }
  return words;
}

uint32_t reversed(uint32_t value, int width) {
  uint32_t out = 0;
  for (int k = 0; k < width; ++k) out |= (value >> k & 1) << (width - 1 - k);
  return out;
}

// Check values of the catalogue of parametrised CRC algorithms (Cook,
// https://reveng.sourceforge.io/crc-catalogue).
TEST(LinkCode, GivesThePublishedCheckValues) {
  const auto low = digits(false), high = digits(true);
  EXPECT_EQ(CrcTable({16, 0x3D65, 0})(low.data(), 72) ^ 0xFFFF, 0xEA82u);  // CRC-16/DNP
  EXPECT_EQ(CrcTable({16, 0x1021, 0xFFFF})(low.data(), 72), 0x6F91u);      // CRC-16/MCRF4XX
  EXPECT_EQ(CrcTable({16, 0x1021, 0})(low.data(), 72), 0x2189u);           // CRC-16/KERMIT
  EXPECT_EQ(CrcTable({32, 0x04C11DB7, 0xFFFFFFFF})(low.data(), 72) ^ 0xFFFFFFFF, 0xCBF43926u);  // CRC-32
  // Those that take bit 7 of a byte first give the remainder the other way round.
  EXPECT_EQ(reversed(CrcTable({16, 0x3D65, 0})(high.data(), 72), 16) ^ 0xFFFF, 0xC2B7u);  // EN-13757
  EXPECT_EQ(reversed(CrcTable({16, 0x5935, 0xFFFF})(high.data(), 72), 16), 0x772Bu);      // CRC-16/M17
  EXPECT_EQ(reversed(CrcTable({16, 0x1021, 0})(high.data(), 72), 16), 0x31C3u);           // XMODEM
  EXPECT_EQ(reversed(CrcTable({8, 0x2F, 0xFF})(high.data(), 72), 8) ^ 0xFF, 0xDFu);       // AUTOSAR
  EXPECT_EQ(CrcTable({8, 0x39, 0})(low.data(), 72), 0x15u);                               // DARC
}

// What each wrong bit of {message, check} adds to the remainder.
std::vector<uint32_t> syndromes(const Crc& crc, int message) {
  const CrcTable linear({crc.width, crc.polynomial, 0});
  std::vector<uint32_t> out;
  for (int k = 0; k < message; ++k) {
    std::array<uint64_t, 8> word{};
    word[static_cast<size_t>(k / 64)] = uint64_t{1} << (k % 64);
    out.push_back(linear(word.data(), message));
  }
  for (int k = 0; k < crc.width; ++k) out.push_back(1u << k);
  return out;
}

// The least number of wrong bits that go unseen, looked for up to 6.
int distance(const std::vector<uint32_t>& s) {
  std::unordered_set<uint32_t> one(s.begin(), s.end()), two;
  if (one.count(0) != 0) return 1;
  if (one.size() < s.size()) return 2;
  bool four = false;
  for (size_t i = 0; i < s.size(); ++i)
    for (size_t j = 0; j < i; ++j) {
      const uint32_t sum = s[i] ^ s[j];
      if (one.count(sum) != 0) return 3;
      four |= !two.insert(sum).second;
    }
  if (four) return 4;
  for (size_t i = 0; i < s.size(); ++i)
    for (size_t j = 0; j < i; ++j)
      for (size_t k = 0; k < j; ++k)
        if (two.count(s[i] ^ s[j] ^ s[k]) != 0) return 5;
  return 6;
}

// At each polynomial's longest message the distance is what the code says, and one bit more loses it: the
// lengths are those of Koopman's tables.
TEST(LinkCode, HasTheDistanceThatItSaysUpToItsLength) {
  for (const auto& [bits, polynomial, expected] :
       {std::tuple{1, 0x3D65u, 6}, std::tuple{64, 0x3D65u, 6}, std::tuple{130, 0x3D65u, 6},
        std::tuple{131, 0x5935u, 5}, std::tuple{236, 0x5935u, 5}, std::tuple{237, 0x1021u, 4},
        std::tuple{491, 0x1021u, 4}}) {
    const LinkCode code = link_code(LinkCheck::retry, bits);
    EXPECT_EQ(code.beat.polynomial, polynomial) << bits;
    EXPECT_EQ(code.distance, expected) << bits;
    EXPECT_GE(distance(syndromes(code.beat, bits + 5)), expected) << bits;
  }
  EXPECT_EQ(distance(syndromes({16, 0x3D65, 0xFFFF}, 135)), 6);
  EXPECT_LT(distance(syndromes({16, 0x3D65, 0xFFFF}, 136)), 6);
  EXPECT_EQ(distance(syndromes({16, 0x5935, 0xFFFF}, 241)), 5);
  EXPECT_LT(distance(syndromes({16, 0x5935, 0xFFFF}, 242)), 5);
  const LinkCode code = link_code(LinkCheck::detect, 64);
  EXPECT_EQ(distance(syndromes(code.ack, code.sequence_bits)), 6);
  EXPECT_EQ(link_code(LinkCheck::none, 64).wire_bits, 64);
  EXPECT_EQ(code.wire_bits, 64 + 4 + 16);
  EXPECT_EQ(code.ack_bits, 12);
  EXPECT_LT(code.window, 1 << code.sequence_bits);
}

// A burst of 16 bits or less is seen wherever it lies, by each of the three polynomials: all patterns at
// every place.
TEST(LinkCode, SeesEachBurstUpToItsWidth) {
  for (const int bits : {66, 150, 300}) {
    const LinkCode code = link_code(LinkCheck::retry, bits);
    const std::vector<uint32_t> s = syndromes(code.beat, bits + 5);
    uint64_t bursts = 0;
    for (size_t first = 0; first < s.size(); ++first) {
      const size_t width = std::min<size_t>(16, s.size() - first);
      // In Gray order one bit changes from pattern to pattern; the first bit is always wrong.
      uint32_t sum = s[first];
      ASSERT_NE(sum, 0u);
      for (uint32_t k = 1; k < 1u << (width - 1); ++k, ++bursts) {
        sum ^= s[first + 1 + static_cast<size_t>(__builtin_ctz(k))];
        if (sum == 0) FAIL() << "a burst at bit " << first << " of " << bits;
      }
    }
    EXPECT_GT(bursts, static_cast<uint64_t>(bits) << 14);
  }
}

// Beats go through the code and back; each wrong bit, and each wrong pair of bits, of a random beat is seen.
TEST(LinkCode, OpensWhatItSealsAndNothingElse) {
  for (const std::string name : {"narrow_links.retry", "rich_damped.detect", "flat.retry"}) {
    const Plan plan = make_case(name).setup.plan;
    const emu::BeatCode code(plan);
    Dice dice(7);
    const int all = plan.link.wire_bits + 1, payload = plan.words.link_bits;
    const auto flip = [&](emu::Beat& wire, int i) {
      if (i == all - 1)
        wire.end = !wire.end;
      else
        wire.payload.word[static_cast<size_t>(i / 64)] ^= uint64_t{1} << (i % 64);
    };
    for (uint32_t sequence = 0; sequence < 16; ++sequence) {
      emu::Beat beat, wire, back;
      beat.end = dice.chance(30);
      for (int k = 0; k < payload; ++k) beat.payload.put(k, 1, dice.chance(50));
      code.seal(beat, sequence, wire);
      ASSERT_TRUE(code.open(wire, back));
      EXPECT_EQ(code.sequence(wire), sequence);
      EXPECT_EQ(back.end, beat.end);
      EXPECT_EQ(back.payload, beat.payload);
      for (int i = 0; i < all; ++i) {
        emu::Beat one = wire;
        flip(one, i);
        ASSERT_FALSE(code.open(one, back)) << i;
        for (int j = 0; j < i; ++j) {
          emu::Beat two = one;
          flip(two, j);
          ASSERT_FALSE(code.open(two, back)) << i << " " << j;
        }
      }
      // An acknowledgement: all wrong words of up to five bits.
      const uint16_t ack = code.acknowledge(sequence);
      EXPECT_TRUE(code.acknowledges(ack));
      for (uint32_t error = 1; error < 1u << plan.link.ack_bits; ++error) {
        if (__builtin_popcount(error) < 6) {
          ASSERT_FALSE(code.acknowledges(static_cast<uint16_t>(ack ^ error)));
        }
      }
    }
  }
}

TEST(LinkCode, IsReadFromTheArch) {
  const auto check_of = [](const std::string& value) {
    return parse_arch("name = \"a\"\n[link]\ncheck = " + value + "\n", "a.toml").link_check;
  };
  EXPECT_EQ(check_of("\"none\""), LinkCheck::none);
  EXPECT_EQ(check_of("\"detect\""), LinkCheck::detect);
  EXPECT_EQ(check_of("\"retry\""), LinkCheck::retry);
  EXPECT_EQ(refused_with([&] { check_of("\"retri\""); }),
            "a.toml:3:9: unknown link check 'retri'\n  hint: did you mean 'retry'?");
}

// A plan without a check is what it was: its hash too.
TEST(LinkCode, AddsNothingWhereItIsNotAskedFor) {
  const Plan none = make_case("flat").setup.plan, detect = make_case("flat.detect").setup.plan,
             retry = make_case("flat.retry").setup.plan;
  EXPECT_EQ(none.link.wire_bits, none.words.link_bits);
  EXPECT_EQ(none.link.latency, 0);
  EXPECT_EQ(std::set<uint64_t>({none.hash, detect.hash, retry.hash}).size(), 3u);
  EXPECT_EQ(describe(none).find("link check"), std::string::npos);
  EXPECT_NE(describe(retry).find("retry: 4 bits of sequence and 16 of check (0x3d65, distance 6) per beat, "
                                 "2 cycles more"),
            std::string::npos)
      << describe(retry);
}

TEST(LinkCode, RefusesABeatThatTheEnginesDoNotHold) {
  Arch arch;
  arch.link_bits = 500;
  arch.link_check = LinkCheck::retry;
  const Case c = make_case("flat");
  const Plan plan = make_setup(c.scene, arch).plan;
  try {
    emu::check_words(plan);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_EQ(e.keys(), std::vector<std::string>{"link.bits"});
    EXPECT_STREQ(e.what(),
                 "a checked beat of 521 bits: the cycle-accurate engines hold at most 512\n"
                 "  hint: use fewer link.bits");
  }
}

TEST(FaultShare, IsAShareOrANumber) {
  EXPECT_EQ(read_fault_share("10000").count, 10000u);
  EXPECT_EQ(read_fault_share("1e-3").rate, 1e-3);
  EXPECT_EQ(read_fault_share("0.25").rate, 0.25);
  for (const std::string bad : {"0", "-1", "1.5", "some", "", "3x"}) {
    EXPECT_EQ(refused_with([&] { read_fault_share(bad); }),
              "'" + bad +
                  "' faults cannot be injected\n"
                  "  hint: give a share of all beats, as 0.001, or their number in the run, as 10000");
  }
}

}  // namespace
}  // namespace cuboct::test
