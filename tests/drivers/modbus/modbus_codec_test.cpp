#include "drivers/modbus/modbus_codec.h"

#include <gtest/gtest.h>

#include "tests/drivers/hex.h"

namespace luxrig::modbus {
namespace {

Request read_request() { return {17, Function::read_holding, 0x6B, 3, {}}; }

TEST(ModbusCodec, WritesEachRequestAsTheStandardPrintsIt) {
  // transaction, protocol, length, unit, function, address, count
  EXPECT_EQ(encode(read_request(), 0x1234), from_hex("1234 0000 0006 11 03 006b 0003"));
  EXPECT_EQ(encode({1, Function::read_input, 2, 2, {}}, 1), from_hex("0001 0000 0006 01 04 0002 0002"));
  // … address, value
  EXPECT_EQ(encode({1, Function::write_single, 0, 1, {255}}, 2), from_hex("0002 0000 0006 01 06 0000 00ff"));
  // … address, count, byte count, values
  EXPECT_EQ(encode({1, Function::write_multiple, 10, 0, {128, 512}}, 3),
            from_hex("0003 0000 000b 01 10 000a 0002 04 0080 0200"));
}

// Vectors: Modbus Application Protocol 1.1b3, the examples of 6.1, 6.2, 6.5 and 6.11.
TEST(ModbusCodec, EncodesCoilsAndDiscreteInputsAsTheStandardPrintsThem) {
  const Request coils{1, Function::read_coils, 0x13, 0x13, {}};
  EXPECT_EQ(encode_pdu(coils), from_hex("01 0013 0013"));
  const Answer read = decode_pdu(coils, from_hex("01 03 cd 6b 05"));
  ASSERT_EQ(read.verdict, Verdict::good);
  // Outputs 27 to 20 are 1100 1101, 35 to 28 are 0110 1011, 38 to 36 are 101.
  EXPECT_EQ(read.values, (std::vector<std::uint16_t>{1, 0, 1, 1, 0, 0, 1, 1, 1, 1, 0, 1, 0, 1, 1, 0, 1, 0, 1}));
  const Request inputs{1, Function::read_discrete, 0xC4, 0x16, {}};
  EXPECT_EQ(encode_pdu(inputs), from_hex("02 00c4 0016"));
  const Answer status = decode_pdu(inputs, from_hex("02 03 ac db 35"));
  ASSERT_EQ(status.verdict, Verdict::good);
  EXPECT_EQ(status.values,
            (std::vector<std::uint16_t>{0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 0, 1, 1, 0, 1, 1, 1, 0, 1, 0, 1, 1}));
  const Request on{1, Function::write_coil, 0xAC, 0, {1}}, off{1, Function::write_coil, 0xAC, 0, {0}};
  EXPECT_EQ(encode_pdu(on), from_hex("05 00ac ff00"));
  EXPECT_EQ(encode_pdu(off), from_hex("05 00ac 0000"));
  EXPECT_EQ(decode_pdu(on, from_hex("05 00ac ff00")).verdict, Verdict::good);
  EXPECT_EQ(decode_pdu(on, from_hex("05 00ac 0000")).verdict, Verdict::garbled);
  const Request ten{1, Function::write_coils, 0x13, 0, {1, 0, 1, 1, 0, 0, 1, 1, 1, 0}};
  EXPECT_EQ(encode_pdu(ten), from_hex("0f 0013 000a 02 cd01"));
  EXPECT_EQ(decode_pdu(ten, from_hex("0f 0013 000a")).verdict, Verdict::good);
  EXPECT_EQ(decode_pdu(ten, from_hex("0f 0013 0009")).verdict, Verdict::garbled);
}

TEST(ModbusCodec, RefusesCorruptBitsAndIgnoresPadding) {
  const Request inputs{1, Function::read_discrete, 0, 3, {}};
  EXPECT_EQ(decode_pdu(inputs, from_hex("02 01 fd")).values, (std::vector<std::uint16_t>{1, 0, 1}))
      << "padding is ones";
  for (const char* bad : {"02 02 05", "02 01", "02 01 05 00", "01 01 05", "02 00", "82", "82 02 00"})
    EXPECT_EQ(decode_pdu(inputs, from_hex(bad)).verdict, Verdict::garbled) << bad;
  EXPECT_EQ(decode_pdu(inputs, from_hex("82 02")).exception_code, 2);
}

TEST(ModbusCodec, ReadsEachAnswer) {
  const Request lux{1, Function::read_holding, 2, 2, {}};
  const Answer answer = decode(lux, 9, from_hex("0009 0000 0007 01 03 04 0007 a120"));
  EXPECT_EQ(answer.verdict, Verdict::good);
  EXPECT_EQ(answer.values, (std::vector<std::uint16_t>{0x0007, 0xA120}));
  EXPECT_EQ(decode({1, Function::write_single, 0, 1, {255}}, 2, from_hex("0002 0000 0006 01 06 0000 00ff")).verdict,
            Verdict::good);
  EXPECT_EQ(
      decode({1, Function::write_multiple, 10, 0, {128, 512}}, 3, from_hex("0003 0000 0006 01 10 000a 0002")).verdict,
      Verdict::good);
}

TEST(ModbusCodec, NamesExceptions) {
  const Answer answer = decode(read_request(), 5, from_hex("0005 0000 0003 11 83 02"));
  EXPECT_EQ(answer.verdict, Verdict::exception);
  EXPECT_EQ(answer.exception_code, 2);
  EXPECT_EQ(exception_name(2), "illegal data address (2)");
  EXPECT_EQ(exception_name(11), "gateway target does not respond (11)");
  EXPECT_EQ(exception_name(77), "unknown exception (77)");
}

TEST(ModbusCodec, DistinguishesAnotherTransactionFromGarbage) {
  const Answer answer = decode(read_request(), 6, from_hex("0005 0000 0009 11 03 06 0001 0002 0003"));
  EXPECT_EQ(answer.verdict, Verdict::foreign);
  EXPECT_EQ(answer.transaction, 5);
}

TEST(ModbusCodec, RefusesTruncationsExtensionsAndChangedFields) {
  const auto good = from_hex("0005 0000 0009 11 03 06 0001 0002 0003");
  ASSERT_EQ(decode(read_request(), 5, good).verdict, Verdict::good);
  for (std::size_t size = 0; size < good.size(); ++size) {
    EXPECT_EQ(decode(read_request(), 5, {good.data(), size}).verdict, Verdict::garbled) << size;
  }
  auto longer = good;
  longer.push_back(0);
  EXPECT_EQ(decode(read_request(), 5, longer).verdict, Verdict::garbled);
  for (std::size_t at = 0; at < 9; ++at) {
    for (int flip = 1; flip < 256; ++flip) {
      auto bad = good;
      bad[at] = static_cast<std::uint8_t>(bad[at] ^ flip);
      const Verdict verdict = decode(read_request(), 5, bad).verdict;
      EXPECT_NE(verdict, Verdict::good) << at << " " << flip;
      if (at < 2) {
        EXPECT_EQ(verdict, Verdict::foreign);
      }
    }
  }
}

TEST(ModbusCodec, RefusesAWriteWhoseEchoDiffers) {
  const Request request{1, Function::write_single, 4, 1, {255}};
  EXPECT_EQ(decode(request, 2, from_hex("0002 0000 0006 01 06 0005 00ff")).verdict, Verdict::garbled);
  EXPECT_EQ(decode(request, 2, from_hex("0002 0000 0006 01 06 0004 00fe")).verdict, Verdict::garbled);
  const Request multiple{1, Function::write_multiple, 10, 0, {1, 2}};
  EXPECT_EQ(decode(multiple, 3, from_hex("0003 0000 0006 01 10 000a 0001")).verdict, Verdict::garbled);
}

}  // namespace
}  // namespace luxrig::modbus
