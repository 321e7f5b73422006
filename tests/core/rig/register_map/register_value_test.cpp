#include "core/rig/register_map/register_value.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace luxrig {
namespace {

RegisterWords words(std::uint16_t first) { return {{first, 0}, 1}; }
RegisterWords words(std::uint16_t first, std::uint16_t second) { return {{first, second}, 2}; }

TEST(RegisterValue, SupportsEveryWordAndByteOrder) {
  // 123456.0 is 47F1 2000 in IEEE 754; 500 000 is 0007 A120.
  const RegisterFormat abcd{2, RegisterNumber::floating, false, false}, cdab{2, RegisterNumber::floating, true, false},
      badc{2, RegisterNumber::floating, false, true}, dcba{2, RegisterNumber::floating, true, true};
  EXPECT_EQ(words_of(123456.0, abcd), words(0x47F1, 0x2000));
  EXPECT_EQ(words_of(123456.0, cdab), words(0x2000, 0x47F1));
  EXPECT_EQ(words_of(123456.0, badc), words(0xF147, 0x0020));
  EXPECT_EQ(words_of(123456.0, dcba), words(0x0020, 0xF147));
  for (const RegisterFormat& format : {abcd, cdab, badc, dcba}) {
    EXPECT_EQ(value_of(words_of(123456.0, format).word, format), 123456.0);
  }
  const RegisterFormat u32{2, RegisterNumber::whole, false, false};
  EXPECT_EQ(words_of(500000, u32), words(0x0007, 0xA120));
  EXPECT_EQ(value_of(words(0xFFFF, 0xFFFF).word, u32), 4294967295.0);
}

TEST(RegisterValue, SignedNumbersAreTwosComplement) {
  const RegisterFormat s16{1, RegisterNumber::signed_whole, false, false},
      s32{2, RegisterNumber::signed_whole, false, false};
  EXPECT_EQ(words_of(-1, s16), words(0xFFFF));
  EXPECT_EQ(words_of(-32768, s16), words(0x8000));
  EXPECT_EQ(words_of(-2, s32), words(0xFFFF, 0xFFFE));
  const std::uint16_t minus[] = {0xFF9C};
  EXPECT_EQ(value_of(minus, s16), -100.0);
  const std::uint16_t wide[] = {0xFFFF, 0xFF9C};
  EXPECT_EQ(value_of(wide, s32), -100.0);
}

TEST(RegisterValue, RoundsToNearestAndSaturates) {
  const RegisterFormat u16{};
  EXPECT_EQ(words_of(0.5, u16), words(1));
  EXPECT_EQ(words_of(-3, u16), words(0));
  EXPECT_EQ(words_of(1e9, u16), words(0xFFFF));
  EXPECT_EQ(words_of(std::numeric_limits<double>::infinity(), u16), words(0xFFFF));
  const RegisterFormat single{2, RegisterNumber::floating, false, false};
  EXPECT_TRUE(std::isfinite(value_of(words_of(1e300, single).word, single)));
}

}  // namespace
}  // namespace luxrig
