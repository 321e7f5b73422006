#include "sim/wire/modbus/modbus_session.h"

#include <gtest/gtest.h>

#include <map>

namespace luxrig::sim {
namespace {

using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

// Unit 1: holding registers 2, 3 = 500000 and input registers 2, 3 = 0x1234, 0x5678. Unit 10: holding registers 10, 11,
// which accept up to 1000.
class TwoUnits final : public ModbusUnits {
 public:
  bool has(int unit) const override { return unit == 1 || unit == 10; }
  std::optional<ModbusException> read(int unit, RegisterKind kind, int first,
                                      std::span<std::uint16_t> values) override {
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto found = registers.find({unit, kind == RegisterKind::input, first + static_cast<int>(i)});
      if (found == registers.end()) return ModbusException::illegal_address;
      values[i] = found->second;
    }
    return std::nullopt;
  }
  std::optional<ModbusException> write(int unit, int first, std::span<const std::uint16_t> values) override {
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!registers.contains({unit, false, first + static_cast<int>(i)})) return ModbusException::illegal_address;
      if (values[i] > 1000) return ModbusException::illegal_value;
    }
    for (std::size_t i = 0; i < values.size(); ++i) registers[{unit, false, first + static_cast<int>(i)}] = values[i];
    return std::nullopt;
  }
  Disturbance disturbance(int) override { return trouble; }

  std::map<std::tuple<int, bool, int>, std::uint16_t> registers = {
      {{1, false, 2}, 0x0007}, {{1, false, 3}, 0xa120}, {{1, true, 2}, 0x1234},
      {{1, true, 3}, 0x5678},  {{10, false, 10}, 0},    {{10, false, 11}, 0},
  };
  Disturbance trouble;
};

Bytes read_meter() {
  return {
      0x00, 0x2a,  // transaction
      0x00, 0x00,  // protocol
      0x00, 0x06,  // length: unit and PDU
      0x01,        // unit
      0x03,        // read holding registers
      0x00, 0x02,  // first
      0x00, 0x02   // count
  };
}

Bytes meter_answer() {
  return {
      0x00, 0x2a,             // the same transaction
      0x00, 0x00,             // protocol
      0x00, 0x07,             // length
      0x01,                   // unit
      0x03,                   // function
      0x04,                   // bytes
      0x00, 0x07, 0xa1, 0x20  // 500000
  };
}

Bytes write_two() {
  return {
      0x12, 0x34,             // transaction
      0x00, 0x00,             // protocol
      0x00, 0x0b,             // length
      0x0a,                   // unit
      0x10,                   // write registers
      0x00, 0x0a,             // first
      0x00, 0x02,             // count
      0x04,                   // bytes
      0x00, 0x80, 0x02, 0x00  // 128, 512
  };
}

// The bytes of all answers, in sequence.
Bytes answers_of(ModbusSession& session, const Bytes& sent, ModbusUnits& units) {
  Bytes all;
  for (const ModbusReply& reply : session.receive(sent, units)) {
    all.insert(all.end(), reply.bytes.begin(), reply.bytes.end());
  }
  return all;
}

Bytes answer(const Bytes& sent, ModbusUnits& units) {
  ModbusSession session;
  return answers_of(session, sent, units);
}

// PDU in, PDU out, for unit 1 or another.
Bytes pdu(const Bytes& request, ModbusUnits& units, int unit = 10) { return answer_pdu(unit, request, units); }

TEST(ModbusFarEnd, AnswersAReadOfHoldingRegisters) {
  TwoUnits units;
  EXPECT_EQ(answer(read_meter(), units), meter_answer());
}

TEST(ModbusFarEnd, AnswersAReadOfInputRegisters) {
  TwoUnits units;
  Bytes request = read_meter();
  request[7] = 0x04;
  EXPECT_EQ(answer(request, units), (Bytes{0x00, 0x2a, 0, 0, 0, 7, 1, 0x04, 4, 0x12, 0x34, 0x56, 0x78}));
}

TEST(ModbusFarEnd, EchoesAWriteOfOneRegister) {
  TwoUnits units;
  const Bytes request = {
      0xff, 0xfe,  // transaction
      0x00, 0x00,  // protocol
      0x00, 0x06,  // length
      0x0a,        // unit
      0x06,        // write one register
      0x00, 0x0b,  // address
      0x03, 0xe8   // 1000
  };
  EXPECT_EQ(answer(request, units), request);
  EXPECT_EQ((units.registers[{10, false, 11}]), 1000);
}

TEST(ModbusFarEnd, AnswersAWriteOfSeveralRegistersWithFirstAndCount) {
  TwoUnits units;
  EXPECT_EQ(answer(write_two(), units), (Bytes{0x12, 0x34, 0, 0, 0, 6, 0x0a, 0x10, 0x00, 0x0a, 0x00, 0x02}));
  EXPECT_EQ((units.registers[{10, false, 10}]), 128);
  EXPECT_EQ((units.registers[{10, false, 11}]), 512);
}

TEST(ModbusFarEnd, RefusesEveryOtherFunctionWithException1) {
  TwoUnits units;
  for (int function = 0; function < 256; ++function) {
    if (function == 3 || function == 4 || function == 6 || function == 16) continue;
    const auto code = static_cast<std::uint8_t>(function);
    EXPECT_EQ(pdu({code, 0, 10, 0, 1}, units), (Bytes{static_cast<std::uint8_t>(code | 0x80), 1})) << function;
  }
}

TEST(ModbusFarEnd, RefusesMissingRegistersWithException2) {
  TwoUnits units;
  EXPECT_EQ(pdu({3, 0, 9, 0, 1}, units), (Bytes{0x83, 2}));
  EXPECT_EQ(pdu({3, 0, 11, 0, 2}, units), (Bytes{0x83, 2}));       // the second one is missing
  EXPECT_EQ(pdu({4, 0, 10, 0, 1}, units), (Bytes{0x84, 2}));       // the other kind
  EXPECT_EQ(pdu({6, 0, 12, 0, 1}, units), (Bytes{0x86, 2}));
  EXPECT_EQ(pdu({3, 0xff, 0xff, 0, 2}, units), (Bytes{0x83, 2}));  // past 65535
  EXPECT_EQ(pdu({16, 0xff, 0xff, 0, 2, 4, 0, 1, 0, 1}, units), (Bytes{0x90, 2}));
}

TEST(ModbusFarEnd, RefusesCountsAndValuesOutOfRangeWithException3) {
  TwoUnits units;
  EXPECT_EQ(pdu({3, 0, 10, 0, 0}, units), (Bytes{0x83, 3}));
  EXPECT_EQ(pdu({3, 0, 10, 0, 126}, units), (Bytes{0x83, 3}));
  EXPECT_EQ(pdu({3, 0, 10, 0, 125}, units), (Bytes{0x83, 2}));  // the maximum count, but the registers do not exist
  EXPECT_EQ(pdu({4, 0, 10, 1, 0}, units), (Bytes{0x84, 3}));
  EXPECT_EQ(pdu({6, 0, 10, 3, 0xe9}, units), (Bytes{0x86, 3}));            // 1001
  EXPECT_EQ(pdu({16, 0, 10, 0, 0, 0}, units), (Bytes{0x90, 3}));           // none
  EXPECT_EQ(pdu({16, 0, 10, 0, 2, 3, 0, 1, 0}, units), (Bytes{0x90, 3}));  // byte count is not twice the count
  EXPECT_EQ(pdu({16, 0, 10, 0, 1, 2, 0}, units), (Bytes{0x90, 3}));        // a byte is missing
  EXPECT_EQ(pdu({16, 0, 10, 0, 1, 2, 0, 1, 0}, units), (Bytes{0x90, 3}));  // one too many
  Bytes most = {16, 0, 10, 0, 124, 248};
  most.resize(6 + 248, 0);
  EXPECT_EQ(pdu(most, units), (Bytes{0x90, 3}));
  EXPECT_EQ((units.registers[{10, false, 10}]), 0);
}

TEST(ModbusFarEnd, APartlyRefusedWriteWritesNothing) {
  TwoUnits units;
  EXPECT_EQ(pdu({16, 0, 10, 0, 2, 4, 0, 5, 0x0f, 0xff}, units), (Bytes{0x90, 3}));
  EXPECT_EQ((units.registers[{10, false, 10}]), 0);
}

TEST(ModbusFarEnd, RefusesEveryTruncatedRequestWithException3) {
  TwoUnits units;
  for (const Bytes& whole :
       {Bytes{3, 0, 10, 0, 1}, Bytes{4, 0, 10, 0, 1}, Bytes{6, 0, 10, 0, 1}, Bytes{16, 0, 10, 0, 2, 4, 0, 1, 0, 2}}) {
    for (std::size_t length = 1; length < whole.size(); ++length) {
      const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
      EXPECT_EQ(pdu(cut, units), (Bytes{static_cast<std::uint8_t>(whole[0] | 0x80), 3}))
          << "function " << int{whole[0]} << ", " << length << " bytes";
    }
  }
  EXPECT_EQ((units.registers[{10, false, 10}]), 0);
}

TEST(ModbusFarEnd, AGatewayReportsAMissingUnitWithException11) {
  TwoUnits units;
  Bytes request = read_meter();
  request[6] = 0x63;
  EXPECT_EQ(answer(request, units), (Bytes{0x00, 0x2a, 0, 0, 0, 3, 0x63, 0x83, 11}));
}

TEST(ModbusFarEnd, AnswersRequestsInAnyFragments) {
  Bytes stream = read_meter();
  for (const std::uint8_t byte : write_two()) stream.push_back(byte);
  for (const std::uint8_t byte : read_meter()) stream.push_back(byte);
  Bytes expected = meter_answer();
  for (const std::uint8_t byte : Bytes{0x12, 0x34, 0, 0, 0, 6, 0x0a, 0x10, 0x00, 0x0a, 0x00, 0x02})
    expected.push_back(byte);
  for (const std::uint8_t byte : meter_answer()) expected.push_back(byte);
  for (std::size_t piece = 1; piece <= stream.size(); ++piece) {
    TwoUnits units;
    ModbusSession session;
    Bytes answers;
    for (std::size_t at = 0; at < stream.size(); at += piece) {
      const auto begin = stream.begin() + static_cast<std::ptrdiff_t>(at);
      const auto length = static_cast<std::ptrdiff_t>(std::min(piece, stream.size() - at));
      const Bytes some = answers_of(session, Bytes(begin, begin + length), units);
      answers.insert(answers.end(), some.begin(), some.end());
    }
    EXPECT_EQ(answers, expected) << "pieces of " << piece;
    EXPECT_FALSE(session.broken());
  }
}

TEST(ModbusFarEnd, HoldsItsAnswerUntilTheLastByteOfARequest) {
  TwoUnits units;
  ModbusSession session;
  const Bytes request = read_meter();
  for (std::size_t at = 0; at + 1 < request.size(); ++at) {
    EXPECT_TRUE(session.receive({&request[at], 1}, units).empty()) << at;
  }
  EXPECT_EQ(session.receive({&request.back(), 1}, units).size(), 1u);
}

TEST(ModbusFarEnd, AbandonsAStreamThatCannotBeModbus) {
  for (const auto& [at, value] : {std::pair{2, 1}, {3, 1}, {4, 1}, {5, 0}, {5, 1}, {5, 255}}) {
    TwoUnits units;
    ModbusSession session;
    Bytes stream = read_meter(), second = read_meter();
    second[static_cast<std::size_t>(at)] = static_cast<std::uint8_t>(value);
    stream.insert(stream.end(), second.begin(), second.end());
    EXPECT_EQ(session.receive(stream, units).size(), 1u);  // the good one that came before
    EXPECT_TRUE(session.broken()) << at << " = " << value;
    EXPECT_TRUE(session.receive(read_meter(), units).empty());
  }
}

TEST(ModbusFarEnd, ASilentUnitLosesTheWriteWithoutAnAnswer) {
  TwoUnits units;
  units.trouble.silent = true;
  EXPECT_TRUE(answer(write_two(), units).empty());
  EXPECT_EQ((units.registers[{10, false, 10}]), 0);
}

TEST(ModbusFarEnd, ASlowUnitStatesItsDelay) {
  TwoUnits units;
  units.trouble.delay = 300ms;
  ModbusSession session;
  const auto replies = session.receive(read_meter(), units);
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_EQ(replies[0].delay, 300ms);
  EXPECT_EQ(replies[0].bytes, meter_answer());
}

TEST(ModbusFarEnd, AFaultyUnitAnswersWithItsException) {
  TwoUnits units;
  units.trouble.exception = 4;
  EXPECT_EQ(answer(read_meter(), units), (Bytes{0x00, 0x2a, 0, 0, 0, 3, 1, 0x83, 4}));
  EXPECT_EQ(answer(write_two(), units), (Bytes{0x12, 0x34, 0, 0, 0, 3, 10, 0x90, 4}));
  EXPECT_EQ((units.registers[{10, false, 10}]), 0);
}

// Checks a master must make before it accepts an answer to read_meter().
bool believable(const Bytes& reply) {
  return reply.size() == 13 && Bytes(reply.begin(), reply.begin() + 9) == Bytes{0x00, 0x2a, 0, 0, 0, 7, 1, 3, 4};
}

TEST(ModbusFarEnd, GarblesAnswersInEveryWayAndNeverIntoAValidOne) {
  TwoUnits units;
  std::map<std::size_t, int> lengths;
  for (std::uint64_t random = 0; random < 6 * 4096; ++random) {
    units.trouble.garbled = true;
    units.trouble.random = random * 0x9e3779b97f4a7c15u;
    const Bytes reply = answer(read_meter(), units);
    EXPECT_FALSE(believable(reply)) << random;
    EXPECT_GE(reply.size(), 7u);
    ++lengths[reply.size()];
  }
  EXPECT_TRUE(believable(meter_answer()));
  for (std::size_t length = 7; length <= 29; ++length) EXPECT_GT(lengths[length], 0) << length;
}

TEST(ModbusFarEnd, EveryGarbledRefusalDiffersFromTheRefusal) {
  const Bytes refusal = {0x00, 0x2a, 0, 0, 0, 3, 1, 0x83, 2};
  for (std::uint64_t random = 0; random < 6 * 4096; ++random) {
    EXPECT_NE(garbled_reply(refusal, random * 0x9e3779b97f4a7c15u), refusal) << random;
  }
}

/// Unit 3: coils 19 to 37 and discrete inputs 196 to 217, as in the standard's examples.
class BitUnits final : public ModbusUnits {
 public:
  bool has(int unit) const override { return unit == 3 || unit == 4; }
  bool has_bits(int unit) const override { return unit == 3; }
  std::optional<ModbusException> read(int, RegisterKind kind, int first, std::span<std::uint16_t> values) override {
    const std::string& bits = kind == RegisterKind::coil ? coils : inputs;
    const int begin = kind == RegisterKind::coil ? 19 : 196;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const int at = first + static_cast<int>(i) - begin;
      if (at < 0 || at >= static_cast<int>(bits.size())) return ModbusException::illegal_address;
      values[i] = bits[static_cast<std::size_t>(at)] == '1' ? 1 : 0;
    }
    return std::nullopt;
  }
  std::optional<ModbusException> write(int, int, std::span<const std::uint16_t>) override {
    return ModbusException::illegal_address;
  }
  std::optional<ModbusException> write_coils(int, int first, std::span<const std::uint16_t> bits) override {
    if (first < 19 || first + static_cast<int>(bits.size()) > 38) return ModbusException::illegal_address;
    for (std::size_t i = 0; i < bits.size(); ++i)
      coils[static_cast<std::size_t>(first - 19) + i] = bits[i] != 0 ? '1' : '0';
    return std::nullopt;
  }
  std::string coils = "1011001111010110101", inputs = "0011010111011011101011";
};

// Application Protocol 1.1b3, examples of 6.1, 6.2, 6.5 and 6.11.
TEST(ModbusSession, HandlesCoilsAndDiscreteInputsAsTheStandardPrintsThem) {
  BitUnits units;
  const auto answer = [&](Bytes request) { return answer_pdu(3, request, units); };
  EXPECT_EQ(answer({1, 0, 0x13, 0, 0x13}), (Bytes{1, 3, 0xcd, 0x6b, 0x05}));
  EXPECT_EQ(answer({2, 0, 0xc4, 0, 0x16}), (Bytes{2, 3, 0xac, 0xdb, 0x35}));
  EXPECT_EQ(answer({5, 0, 0x14, 0xff, 0}), (Bytes{5, 0, 0x14, 0xff, 0}));
  EXPECT_EQ(units.coils.substr(0, 3), "111");
  EXPECT_EQ(answer({15, 0, 0x13, 0, 10, 2, 0xcd, 1}), (Bytes{15, 0, 0x13, 0, 10}));
  EXPECT_EQ(units.coils, "1011001110010110101");
}

TEST(ModbusSession, RefusesInvalidBitRequestsWithTheirException) {
  BitUnits units;
  const auto answer = [&](int unit, Bytes request) { return answer_pdu(unit, request, units); };
  for (const auto function : Bytes{1, 2, 5, 15})
    EXPECT_EQ(answer(4, {function, 0, 0, 0, 0}), (Bytes{static_cast<std::uint8_t>(function | 0x80), 1}));
  EXPECT_EQ(answer(3, {1, 0, 0x13, 0, 0}), (Bytes{0x81, 3})) << "none";
  EXPECT_EQ(answer(3, {1, 0, 0x13, 0x07, 0xd1}), (Bytes{0x81, 3})) << "2001";
  EXPECT_EQ(answer(3, {1, 0, 0x13, 0, 0x14}), (Bytes{0x81, 2})) << "one too many";
  EXPECT_EQ(answer(3, {2, 0xff, 0xff, 0, 2}), (Bytes{0x82, 2})) << "past the last address";
  EXPECT_EQ(answer(3, {5, 0, 0x13, 0, 1}), (Bytes{0x85, 3})) << "neither on nor off";
  EXPECT_EQ(answer(3, {5, 0, 0x12, 0, 0}), (Bytes{0x85, 2}));
  EXPECT_EQ(answer(3, {15, 0, 0x13, 0, 10, 1, 0xcd}), (Bytes{0x8f, 3})) << "too few bytes";
  EXPECT_EQ(answer(3, {15, 0, 0x13, 0, 10}), (Bytes{0x8f, 3}));
  EXPECT_EQ(units.coils, "1011001111010110101") << "nothing was written";
}

}  // namespace
}  // namespace luxrig::sim
