// Modbus TCP put together again from segments that are whole, split, joined, repeated, out of order and lost.
#include "tools/recording/modbus_streams.h"

#include <gtest/gtest.h>

#include "tests/tools/recording/capture_bytes.h"

namespace luxrig::recording {
namespace {

// As Messaging on TCP/IP 1.0b writes them. Unit 1, register 2, two registers; the answer: 0x0002 0x49F0 = 150 000.
CaptureBytes read_request(std::uint8_t transaction) { return {0, transaction, 0, 0, 0, 6, 1, 3, 0, 2, 0, 2}; }
CaptureBytes read_answer(std::uint8_t transaction) { return {0, transaction, 0, 0, 0, 7, 1, 3, 4, 0, 2, 0x49, 0xF0}; }

class Conversation {
 public:
  void asks(const CaptureBytes& bytes) {
    segment(true, asked_, bytes), asked_ += static_cast<std::uint32_t>(bytes.size());
  }
  void answers(const CaptureBytes& bytes) {
    segment(false, answered_, bytes), answered_ += static_cast<std::uint32_t>(bytes.size());
  }
  void segment(bool asks, std::uint32_t sequence, const CaptureBytes& payload) {
    const SocketAddress client{0x0A000001, 40000}, server{0xC000020A, 502};
    streams_.take(Duration(++at_), {asks ? client : server, asks ? server : client, sequence, false, payload},
                  recording_);
  }
  Recording& end() {
    streams_.end(recording_);
    return recording_;
  }
  std::uint32_t asked_ = 0xFFFFFFF0, answered_ = 7;  // the first overflows soon

 private:
  ModbusStreams streams_{{}};
  Recording recording_;
  int at_ = 0;
};

TEST(ModbusStreams, AReadIsMatchedWithItsAnswer) {
  Conversation one;
  one.asks(read_request(9));
  one.answers(read_answer(9));
  const Recording& read = one.end();
  ASSERT_EQ(read.modbus.size(), 1u);
  EXPECT_EQ(read.modbus[0].at, Duration(2));
  EXPECT_EQ(text_of(read.modbus[0].server), "192.0.2.10:502");
  EXPECT_EQ(read.modbus[0].request.unit, 1);
  EXPECT_EQ(read.modbus[0].request.function, modbus::Function::read_holding);
  EXPECT_EQ(read.modbus[0].request.first_register, 2);
  EXPECT_EQ(read.modbus[0].values, (std::vector<std::uint16_t>{0x0002, 0x49F0}));
  EXPECT_EQ(read.modbus_clients, (std::set<std::uint32_t>{0x0A000001}));
  EXPECT_EQ(read.modbus_unanswered, 0u);
}

TEST(ModbusStreams, SegmentsSplitAndJoinFramesAsTheyLike) {
  Conversation one;
  const CaptureBytes both = joined({read_request(1), read_request(2)});
  for (const std::uint8_t byte : both) one.asks({byte});
  one.answers(joined({read_answer(2), {0, 1, 0, 0}}));  // answers may come in another order
  one.answers({0, 7, 1, 3, 4, 0, 2, 0x49, 0xF0});
  EXPECT_EQ(one.end().modbus.size(), 2u);
}

TEST(ModbusStreams, RepeatedSegmentsCountOnceAndLateOnesFindTheirPlace) {
  Conversation one;
  one.asks(read_request(1));
  one.segment(true, one.asked_ - 12, read_request(1));
  one.segment(true, one.asked_ - 1, {0});  // a keep-alive
  one.answers(read_answer(1));
  EXPECT_EQ(one.end().modbus.size(), 1u);
  const CaptureBytes second = read_request(2);
  one.segment(true, one.asked_ + 5, CaptureBytes(second.begin() + 5, second.end()));
  one.segment(true, one.asked_, CaptureBytes(second.begin(), second.begin() + 6));
  one.answers(read_answer(2));
  EXPECT_EQ(one.end().modbus.size(), 2u);
}

TEST(ModbusStreams, ALostSegmentCostsAFewExchanges) {
  Conversation one;
  one.asks(read_request(1));
  one.answers(read_answer(1));
  one.asked_ += 12;  // the capture missed it
  one.answered_ += 13;
  for (std::uint8_t transaction = 3; transaction < 20; ++transaction) {
    one.asks(read_request(transaction));
    one.answers(read_answer(transaction));
  }
  const Recording& read = one.end();
  EXPECT_GE(read.modbus.size(), 1u + 17 - TcpStream::kWait - 1);
}

TEST(ModbusStreams, RefusedGarbledAndUnansweredRequestsAreCounted) {
  Conversation one;
  one.asks(read_request(1));
  one.answers({0, 1, 0, 0, 0, 3, 1, 0x83, 2});  // illegal data address
  one.asks(read_request(2));
  one.answers({0, 2, 0, 0, 0, 5, 1, 3, 2, 0, 2});  // one register too few
  one.asks(read_request(3));
  one.answers({0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF});  // no Modbus
  one.answers(read_answer(4));                                    // nobody asked
  const Recording& read = one.end();
  EXPECT_TRUE(read.modbus.empty());
  EXPECT_EQ(read.modbus_refused, 1u);
  EXPECT_EQ(read.modbus_unanswered, 2u);
}

TEST(ModbusStreams, EveryRequestThatLuxrigEncodesIsDecoded) {
  using modbus::Function;
  for (const modbus::Request& request : {modbus::Request{1, Function::read_coils, 7, 19, {}},
                                         {2, Function::read_discrete, 0, 2000, {}},
                                         {3, Function::read_holding, 65535, 1, {}},
                                         {255, Function::read_input, 9, 125, {}},
                                         {4, Function::write_coil, 3, 1, {1}},
                                         {5, Function::write_single, 3, 1, {0xABCD}},
                                         {6, Function::write_coils, 1, 1, {1, 0, 1, 1, 0, 0, 0, 0, 1}},
                                         {7, Function::write_multiple, 1, 1, {1, 2, 0xFFFF}}}) {
    const std::vector<std::uint8_t> frame = encode(request, 77);
    const auto decoded = decode_request(frame);
    ASSERT_TRUE(decoded.has_value());
    EXPECT_EQ(decoded->unit, request.unit);
    EXPECT_EQ(decoded->function, request.function);
    EXPECT_EQ(decoded->first_register, request.first_register);
    EXPECT_EQ(decoded->values, request.values);
    if (reads(request.function)) {
      EXPECT_EQ(decoded->count, request.count);
    }
    for (std::size_t size = 0; size < frame.size(); ++size)
      EXPECT_FALSE(decode_request({frame.data(), size}).has_value()) << size;
  }
  EXPECT_FALSE(decode_request(CaptureBytes{0, 1, 0, 0, 0, 6, 1, 3, 0, 2, 0, 126}).has_value()) << "too many";
  EXPECT_FALSE(decode_request(CaptureBytes{0, 1, 0, 0, 0, 6, 1, 3, 0, 2, 0, 0}).has_value()) << "none";
  EXPECT_FALSE(decode_request(CaptureBytes{0, 1, 0, 0, 0, 6, 1, 3, 0xFF, 0xFF, 0, 2}).has_value()) << "past the end";
}

}  // namespace
}  // namespace luxrig::recording
