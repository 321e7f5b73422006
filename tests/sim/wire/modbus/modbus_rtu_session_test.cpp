#include "sim/wire/modbus/modbus_rtu_session.h"

#include <gtest/gtest.h>

#include "sim/wire/modbus/line_numbers.h"
#include "tests/drivers/hex.h"
#include "tests/sim/tiny_rig.h"

namespace luxrig::sim {
namespace {

using LineFrame = std::vector<std::uint8_t>;

/// Units 1 and 17: holding register n holds 1000 + n; writes are kept.
class LineUnits final : public ModbusUnits {
 public:
  [[nodiscard]] bool has(int unit) const override { return unit == 1 || unit == 17; }
  std::optional<ModbusException> read(int, RegisterKind, int first, std::span<std::uint16_t> values) override {
    if (first == 2 && values.size() == 2) {
      values[0] = 0x0007;
      values[1] = 0xA120;
      return std::nullopt;
    }
    return ModbusException::illegal_address;
  }
  std::optional<ModbusException> write(int, int first, std::span<const std::uint16_t> values) override {
    written.insert(written.end(), values.begin(), values.end());
    return first < 100 ? std::nullopt : std::optional(ModbusException::illegal_address);
  }
  Disturbance disturbance(int) override { return wrong; }

  std::vector<std::uint16_t> written;
  Disturbance wrong;
};

LineFrame all_of(const std::vector<LinePiece>& pieces) {
  LineFrame all;
  for (const LinePiece& piece : pieces) all.insert(all.end(), piece.bytes.begin(), piece.bytes.end());
  return all;
}

TEST(ModbusRtuSession, AnswersThePublishedRequests) {
  LineUnits units;
  ModbusRtuSession session;
  EXPECT_EQ(all_of(session.receive(at_s(0), from_hex("01 03 0002 0002 65cb"), units)),
            from_hex("01 03 04 0007a120 33ba"));
  EXPECT_EQ(all_of(session.receive(at_s(1), from_hex("01 10 000a 0002 04 0080 0200 7358"), units)),
            from_hex("01 10 000a 0002 61ca"));
  EXPECT_EQ(units.written, (std::vector<std::uint16_t>{0x80, 0x200}));
  const LineFrame single = from_hex("01 06 0000 00ff c98a");
  EXPECT_EQ(all_of(session.receive(at_s(2), single, units)), single);
  EXPECT_EQ(all_of(session.receive(at_s(3), from_hex("11 03 006b 0003 7687"), units)), from_hex("11 83 02 c134"));
}

TEST(ModbusRtuSession, SendsADuplicatedAnswerTwice) {
  LineUnits units;
  units.wrong.duplicated = true;
  ModbusRtuSession session;
  const auto pieces = session.receive(at_s(0), from_hex("01 03 0002 0002 65cb"), units);
  ASSERT_EQ(pieces.size(), 2u);
  for (const LinePiece& piece : pieces) EXPECT_EQ(piece.bytes, from_hex("01 03 04 0007a120 33ba"));
}

TEST(ModbusRtuSession, AnswersNoForeignBrokenOrBroadcastRequests) {
  LineUnits units;
  ModbusRtuSession session;
  EXPECT_TRUE(session.receive(at_s(0), from_hex("01 03 0002 0002 65cc"), units).empty());  // checksum
  LineFrame other = from_hex("02 06 0000 00ff");
  LineFrame everybody = from_hex("00 06 0000 00ff");
  for (LineFrame* frame : {&other, &everybody}) {
    const std::uint16_t sum = line_checksum(*frame);
    frame->push_back(static_cast<std::uint8_t>(sum & 0xff));
    frame->push_back(static_cast<std::uint8_t>(sum >> 8));
    EXPECT_TRUE(session.receive(at_s(1), *frame, units).empty());
  }
  EXPECT_TRUE(units.written.empty());
}

TEST(ModbusRtuSession, JoinsFragmentsAndDropsAnIncompleteFrameAfterSilence) {
  LineUnits units;
  ModbusRtuSession session;
  const LineFrame request = from_hex("01 03 0002 0002 65cb");
  for (std::size_t i = 0; i < request.size(); ++i) {
    const auto pieces = session.receive(at_s(0.001 * static_cast<double>(i)), {&request[i], 1}, units);
    EXPECT_EQ(pieces.empty(), i + 1 < request.size());
  }
  EXPECT_TRUE(session.receive(at_s(1), std::span(request).first(5), units).empty());
  EXPECT_FALSE(session.receive(at_s(1.1), request, units).empty());
}

TEST(ModbusRtuSession, CorruptsAnAnswerAsItsFaultDemands) {
  const LineFrame request = from_hex("01 03 0002 0002 65cb"), right = from_hex("01 03 04 0007a120 33ba");
  LineUnits units;
  ModbusRtuSession session;
  const auto answer = [&](FaultKind kind, double value) {
    units.wrong.on_line = kind;
    units.wrong.on_line_value = value;
    return session.receive(at_s(5), request, units);
  };
  EXPECT_NE(line_checksum(all_of(answer(FaultKind::checksum, 1))), 0);
  EXPECT_EQ(all_of(answer(FaultKind::truncated, 2)), LineFrame(right.begin(), right.end() - 2));
  const LineFrame noisy = all_of(answer(FaultKind::noise, 3));
  EXPECT_EQ(LineFrame(noisy.begin() + 3, noisy.end()), right);
  const LineFrame stranger = all_of(answer(FaultKind::wrong_unit, 1));
  EXPECT_EQ(stranger[0], 2);
  EXPECT_EQ(line_checksum(stranger), 0);
  const LineFrame function = all_of(answer(FaultKind::wrong_function, 1));
  EXPECT_NE(function[1], 3);
  EXPECT_EQ(line_checksum(function), 0);
  const auto halves = answer(FaultKind::gap, 600);
  ASSERT_EQ(halves.size(), 2u);
  EXPECT_EQ(halves[1].due - halves[0].due, std::chrono::milliseconds(600));
  EXPECT_EQ(all_of(halves), right);
}

TEST(LineNumbers, FollowEveryWordOrderOfManuals) {
  using Words = std::vector<std::uint16_t>;
  const RegisterFormat single{2, RegisterNumber::floating, false, false},
      swapped{2, RegisterNumber::floating, true, true};
  EXPECT_EQ(registers_from(123456.0, single), (Words{0x47F1, 0x2000}));
  EXPECT_EQ(registers_from(123456.0, swapped), (Words{0x0020, 0xF147}));
  EXPECT_EQ(registers_from(-100, {1, RegisterNumber::signed_whole, false, false}), (Words{0xFF9C}));
  EXPECT_EQ(registers_from(1e12, {2, RegisterNumber::whole, false, false}), (Words{0xFFFF, 0xFFFF}));
  for (const bool words : {false, true}) {
    for (const bool bytes : {false, true}) {
      for (const RegisterNumber number :
           {RegisterNumber::whole, RegisterNumber::signed_whole, RegisterNumber::floating}) {
        const RegisterFormat format{2, number, words, bytes};
        EXPECT_EQ(number_from(registers_from(500000, format), format), 500000);
      }
    }
  }
}

}  // namespace
}  // namespace luxrig::sim
