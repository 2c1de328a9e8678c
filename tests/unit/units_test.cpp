// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <numbers>

#include "model/base/spelling.h"
#include "model/base/units.h"

namespace cuboct {
namespace {

double value(const char* text, const Quantity& quantity) {
  const ParsedQuantity parsed = parse_quantity(text);
  EXPECT_EQ(parsed.dimension, quantity.dimension) << text;
  EXPECT_EQ(parsed.values.size(), 1U);
  return parsed.values.at(0);
}

// Decimal prefixes cost no rounding: each is the double that the SI literal is.
TEST(Units, AreTheNearestDoubles) {
  EXPECT_EQ(value("0.5 mm", quantity::length), 0.5e-3);
  EXPECT_EQ(value("1.41 g/cm^3", quantity::density), 1410.0);
  EXPECT_EQ(value("3 GPa", quantity::pressure), 3e9);
  EXPECT_EQ(value("0.7 um", quantity::length), 0.7e-6);
  EXPECT_EQ(value("0.7 \u00b5m", quantity::length), 0.7e-6);
  EXPECT_EQ(value("7e-3 km", quantity::length), 7.0);
  EXPECT_EQ(value("-.3e+2 us", quantity::time), -3e-5);
  EXPECT_EQ(value("9.81 m/s^2", quantity::acceleration), 9.81);
  EXPECT_EQ(value("2 mN/mm", quantity::stiffness), 2.0);
  EXPECT_EQ(value("1 kg*m^2/s^2", quantity::energy), 1.0);
  EXPECT_EQ(value("1 kg/(m*s^2)", quantity::pressure), 1.0);
  EXPECT_EQ(value("1 kg/m/s^2", quantity::pressure), 1.0);
  EXPECT_EQ(value("3 N*s/m", quantity::damping), 3.0);
  EXPECT_EQ(value("5 m*s^-1", quantity::velocity), 5.0);
  EXPECT_EQ(value("90 deg", quantity::angle), std::numbers::pi / 2);
  EXPECT_DOUBLE_EQ(value("2 eV", quantity::energy), 2 * 1.602176634e-19);
  EXPECT_EQ(value("2 min", quantity::time), 120.0);
  EXPECT_EQ(value("300 K", quantity::temperature), 300.0);
  EXPECT_EQ(value("4 mK", quantity::temperature), 4e-3);
  EXPECT_EQ(value("1 u", quantity::mass), 1.66053906660e-27);
  EXPECT_DOUBLE_EQ(value("2 ku", quantity::mass), 2e3 * 1.66053906660e-27);
  EXPECT_EQ(value("2 um", quantity::length), 2e-6);
  EXPECT_EQ(value("3 mm", quantity::length), value("3e-3 m", quantity::length));
}

// "m/N*s" is (m/N)*s; a solitary 1 may stand above a fraction.
TEST(Units, BindFromLeftToRight) {
  EXPECT_EQ(parse_quantity("1 m/N*s").dimension, (Dimension{{-1, 0, 3, 0}}));
  EXPECT_EQ(parse_quantity("1 m/(N*s)").dimension, (Dimension{{-1, 0, 1, 0}}));
  EXPECT_EQ(parse_quantity("4 1/s").dimension, (Dimension{{0, 0, -1, 0}}));
  EXPECT_EQ(parse_quantity("4 1/s"), parse_quantity("4 Hz"));
}

TEST(Units, ListsShareOneUnit) {
  const ParsedQuantity parsed = parse_quantity("[0, -0.5,1e1] mm");
  EXPECT_TRUE(parsed.list);
  EXPECT_EQ(parsed.values, (std::vector<double>{0, -0.5e-3, 1e-2}));
}

TEST(Units, RefuseWithTheReason) {
  const auto error = [](const char* text) {
    try {
      parse_quantity(text);
    } catch (const UnitError& e) {
      return e.message + (e.hint.empty() ? "" : " | " + e.hint);
    }
    return std::string("accepted");
  };
  EXPECT_EQ(error("0.5 mmm"), "unknown unit 'mmm' in \"0.5 mmm\" | did you mean 'mm'?");
  EXPECT_EQ(error("3 gPa"), "unknown unit 'gPa' in \"3 gPa\" | did you mean 'GPa'?");
  EXPECT_EQ(error("mm"), "expected a number in \"mm\"");
  EXPECT_EQ(error("1 m/"), "expected a unit in \"1 m/\"");
  EXPECT_EQ(error("1 m^"), "expected an exponent between -9 and 9 after '^' in \"1 m^\"");
  EXPECT_EQ(error("1 m^10"), "expected an exponent between -9 and 9 after '^' in \"1 m^10\"");
  EXPECT_EQ(error("1 (m"), "expected ')' in \"1 (m\"");
  EXPECT_EQ(error("1 m m"), "unexpected 'm' in \"1 m m\" | units are joined by '*' or '/', as in \"N*m\"");
  EXPECT_EQ(error("3 N/mm2"), "unexpected '2' in \"3 N/mm2\" | a power is written with '^': \"^2\"");
  EXPECT_EQ(error("10, 4, 4 mm"),
            "expected a unit in \"10, 4, 4 mm\" | several values stand in brackets, as in \"[10, 4, 4] mm\"");
  EXPECT_EQ(error("27 C"), "unknown unit 'C' in \"27 C\" | temperatures are in K: 0 °C is 273.15 K");
  EXPECT_EQ(error("[1, 2 m"), "expected ',' or ']' in \"[1, 2 m\"");
  EXPECT_EQ(error("1e400 m"), "number out of range in \"1e400 m\"");
  EXPECT_EQ(error("1e99999999999 m"), "number out of range in \"1e99999999999 m\"");
}

TEST(Units, AreNamedInMessages) {
  EXPECT_EQ(describe(quantity::pressure.dimension), "a pressure");
  EXPECT_EQ(describe(Dimension{{1, 2, -3, 0}}), "kg*m^2/s^3");
  EXPECT_EQ(describe(Dimension{{0, 0, -3, 0}}), "1/s^3");
  EXPECT_EQ(describe(Dimension{{1, 2, -2, 0, -1}}), "kg*m^2/s^2/K");
}

TEST(Units, OfSiHaveTheFactorOne) {
  for (const Quantity& q : {quantity::force, quantity::pressure, quantity::energy, quantity::stiffness,
                            quantity::velocity, quantity::temperature, quantity::angular_velocity})
    EXPECT_EQ(parse_quantity("2 " + si_unit(q.dimension)), (ParsedQuantity{{2}, false, q.dimension}))
        << q.name;
  EXPECT_EQ(si_unit(quantity::energy.dimension), "J");
  EXPECT_EQ(si_unit(quantity::damping.dimension), "kg/s");
  EXPECT_EQ(si_unit(Dimension{}), "1");
}

TEST(Spelling, FindsTheNearest) {
  EXPECT_EQ(nearest_spelling("capcity", {"filter_lanes", "capacity"}), "capacity");
  EXPECT_EQ(nearest_spelling("vleocity", {"velocity"}), "velocity");  // two neighbours swapped: one edit
  EXPECT_EQ(nearest_spelling("gpa", {"Pa", "kPa", "GPa"}), "GPa");    // case counts half
  EXPECT_EQ(nearest_spelling("bx", {"box", "sphere"}), "box");
  EXPECT_EQ(nearest_spelling("torus", {"box", "sphere"}), "");
  EXPECT_EQ(nearest_spelling("r", {"x"}), "");
  EXPECT_EQ(list_of({"a", "b", "c"}), "a, b or c");
}

}  // namespace
}  // namespace cuboct
