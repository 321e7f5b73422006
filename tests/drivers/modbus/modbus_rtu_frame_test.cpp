#include "drivers/modbus/modbus_rtu_frame.h"

#include <gtest/gtest.h>

#include "tests/drivers/hex.h"

namespace luxrig::modbus {
namespace {

using RtuBytes = std::vector<std::uint8_t>;

const Request kReadLux{1, Function::read_holding, 2, 2, {}};
const Request kDim{1, Function::write_single, 0, 1, {0x00FF}};

RtuBytes joined(std::initializer_list<RtuBytes> parts) {
  RtuBytes all;
  for (const RtuBytes& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

TEST(ModbusRtuFrame, MakesThePublishedFrames) {
  // Relays: as printed by Waveshare for its Modbus RTU Relay.
  EXPECT_EQ(encode_rtu({1, Function::write_coil, 0, 0, {1}}), from_hex("01 05 0000 ff00 8c3a"));
  EXPECT_EQ(encode_rtu({1, Function::write_coil, 0, 0, {0}}), from_hex("01 05 0000 0000 cdca"));
  EXPECT_EQ(encode_rtu({1, Function::read_coils, 0, 8, {}}), from_hex("01 01 0000 0008 3dcc"));
  EXPECT_EQ(encode_rtu({1, Function::read_discrete, 0, 8, {}}), from_hex("01 02 0000 0008 79cc"));
  EXPECT_EQ(encode_rtu({1, Function::write_coils, 0, 0, {1, 1, 1, 1, 1, 1, 1, 1}}),
            from_hex("01 0f 0000 0008 01 ff be d5"));
  EXPECT_EQ(encode_rtu({0x11, Function::read_holding, 0x6B, 3, {}}), from_hex("11 03 006b 0003 7687"));
  EXPECT_EQ(encode_rtu(kReadLux), from_hex("01 03 0002 0002 65cb"));
  EXPECT_EQ(encode_rtu({1, Function::write_multiple, 10, 0, {0x80, 0x200}}),
            from_hex("01 10 000a 0002 04 0080 0200 7358"));
  EXPECT_EQ(encode_rtu(kDim), from_hex("01 06 0000 00ff c98a"));
  // Waveshare's page: channel 1 to 1 mA.
  EXPECT_EQ(encode_rtu({1, Function::write_single, 0, 1, {1000}}), from_hex("01 06 0000 03e8 8974"));
}

TEST(ModbusRtuFrame, FindsThePublishedAnswers) {
  const RtuSearch lux = find_rtu_answer(kReadLux, from_hex("01 03 04 0007a120 33ba"));
  ASSERT_TRUE(lux.answer);
  EXPECT_EQ(lux.answer->verdict, Verdict::good);
  EXPECT_EQ(lux.answer->values, (std::vector<std::uint16_t>{0x0007, 0xA120}));
  const RtuSearch refused = find_rtu_answer(kReadLux, from_hex("01 83 02 c0f1"));
  ASSERT_TRUE(refused.answer);
  EXPECT_EQ(refused.answer->verdict, Verdict::exception);
  EXPECT_EQ(refused.answer->exception_code, 2);
  EXPECT_EQ(find_rtu_answer(kDim, from_hex("01 06 0000 00ff c98a")).answer->verdict, Verdict::good);
}

TEST(ModbusRtuFrame, FindsAnAnswerAfterNoiseFragmentsAndOtherUnits) {
  const RtuBytes answer = from_hex("01 03 04 0007a120 33ba");
  for (const RtuBytes& before : {from_hex("ff"), from_hex("01"), from_hex("0103"), from_hex("010304"),
                                 from_hex("a12033ba"), from_hex("02 03 04 0000 0000 c933"), from_hex("00ff00ff00ff")}) {
    const RtuSearch found = find_rtu_answer(kReadLux, joined({before, answer}));
    ASSERT_TRUE(found.answer) << before.size();
    EXPECT_EQ(found.answer->verdict, Verdict::good);
    EXPECT_EQ(found.answer->values.at(1), 0xA120);
  }
}

TEST(ModbusRtuFrame, AcceptsNoPrefixOfAnAnswer) {
  const RtuBytes answer = from_hex("01 03 04 0007a120 33ba");
  for (std::size_t size = 0; size < answer.size(); ++size) {
    const RtuSearch found = find_rtu_answer(kReadLux, std::span(answer).first(size));
    EXPECT_FALSE(found.answer) << size;
    EXPECT_FALSE(found.spoiled) << size;
  }
}

TEST(ModbusRtuFrame, DetectsEveryFlippedBit) {
  const RtuBytes answer = from_hex("01 03 04 0007a120 33ba");
  for (std::size_t bit = 0; bit < 8 * answer.size(); ++bit) {
    RtuBytes spoiled = answer;
    spoiled[bit / 8] = static_cast<std::uint8_t>(spoiled[bit / 8] ^ 1u << bit % 8);
    EXPECT_FALSE(find_rtu_answer(kReadLux, spoiled).answer) << bit;
  }
}

TEST(ModbusRtuFrame, DescribesUnusableBytes) {
  EXPECT_EQ(find_rtu_answer(kReadLux, {}).what, "nothing");
  EXPECT_EQ(find_rtu_answer(kReadLux, from_hex("01 03 04 0007a120 33bb")).what, "an answer with a wrong checksum");
  EXPECT_EQ(find_rtu_answer(kReadLux, from_hex("01 03 04 0007")).what, "an answer that stopped half-way");
  EXPECT_EQ(find_rtu_answer(kReadLux, from_hex("01 06 0000 00ff c98a")).what,
            "an answer with function 6 or of another length");
  EXPECT_EQ(find_rtu_answer({2, Function::read_holding, 2, 2, {}}, from_hex("01 03 04 0007a120 33ba")).what,
            "an answer of unit 1");
  EXPECT_EQ(find_rtu_answer(kReadLux, from_hex("aabbcc")).what, "3 bytes that are no answer");
}

TEST(ModbusRtuFrame, AWrongEchoWithARightChecksumIsGarbled) {
  const RtuBytes other = encode_rtu({1, Function::write_single, 0, 1, {0x00FE}});
  const RtuSearch found = find_rtu_answer(kDim, other);
  ASSERT_TRUE(found.answer);
  EXPECT_EQ(found.answer->verdict, Verdict::garbled);
}

}  // namespace
}  // namespace luxrig::modbus
