#include "drivers/modbus/modbus_registers.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>

namespace luxrig::modbus {
namespace {

double lux(const ModbusMeterPatch& patch, std::vector<std::uint16_t> raw) { return lux_from_registers(patch, raw); }

TEST(ModbusRegisters, RoundsADriveToTheNearestCount) {
  const auto raw_of = [](double drive, int full_scale_raw) {
    ModbusPatch patch;
    patch.full_scale_raw = full_scale_raw;
    return words_from_drive(drive, patch).word[0];
  };
  EXPECT_EQ(raw_of(0, 1000), 0);
  EXPECT_EQ(raw_of(1, 1000), 1000);
  EXPECT_EQ(raw_of(0.5004, 1000), 500);
  EXPECT_EQ(raw_of(0.5006, 1000), 501);
  EXPECT_EQ(raw_of(1, 65535), 65535);
  EXPECT_EQ(raw_of(1, 1), 1);
}

TEST(ModbusRegisters, ReadsLuxmetersAsTheirManualsState) {
  EXPECT_DOUBLE_EQ(lux({}, {0x0007, 0xA120}), 500.0);  // milli-lux, high word first
  ModbusMeterPatch swapped;
  swapped.low_word_first = true;
  EXPECT_DOUBLE_EQ(lux(swapped, {0xA120, 0x0007}), 500.0);
  ModbusMeterPatch narrow;
  narrow.registers = 1;
  narrow.lux_per_count = 1;
  EXPECT_DOUBLE_EQ(lux(narrow, {65535}), 65535.0);
}

TEST(ModbusRegisters, KeepsEveryCountOfThirtyTwoBits) {
  ModbusMeterPatch patch;
  patch.lux_per_count = 1;
  EXPECT_EQ(lux(patch, {0xFFFF, 0xFFFF}), 4294967295.0);
  EXPECT_EQ(lux(patch, {0xFFFF, 0xFFFE}), 4294967294.0);
  EXPECT_EQ(lux(patch, {0x8000, 0x0001}), 2147483649.0);
}

TEST(ModbusRegisters, ClipsAtFullScaleAndRejectsReadingsFarBeyondIt) {
  EXPECT_EQ(plausible_lux(0, 1000), 0);
  EXPECT_EQ(plausible_lux(999, 1000), 999);
  EXPECT_EQ(plausible_lux(1040, 1000), 1000);
  EXPECT_FALSE(plausible_lux(1051, 1000));
  EXPECT_FALSE(plausible_lux(-1, 1000));
  EXPECT_FALSE(plausible_lux(std::numeric_limits<double>::quiet_NaN(), 1000));
  EXPECT_FALSE(plausible_lux(std::numeric_limits<double>::infinity(), 1000));
}

}  // namespace
}  // namespace luxrig::modbus
