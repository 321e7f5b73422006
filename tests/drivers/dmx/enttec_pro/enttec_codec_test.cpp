/// Bytes as in ENTTEC's API specification 1.44, and as OLA was seen to send and accept.

#include "drivers/dmx/enttec_pro/enttec_codec.h"

#include <gtest/gtest.h>

#include "tests/drivers/hex.h"

namespace luxrig::enttec {
namespace {

std::vector<Message> all(StreamDecoder& decoder, const std::vector<std::uint8_t>& bytes) {
  std::vector<Message> messages;
  decoder.add(bytes);
  while (auto message = decoder.next()) messages.push_back(std::move(*message));
  return messages;
}

TEST(EnttecCodec, AFullUniverseHas518BytesAndStartsAsPublished) {
  DmxSlots slots{};
  slots[0] = 10;
  slots[1] = 20;
  slots[511] = 255;
  const auto bytes = encode_output(slots);
  ASSERT_EQ(bytes.size(), 518u);
  EXPECT_EQ(std::vector<std::uint8_t>(bytes.begin(), bytes.begin() + 7), from_hex("7e 06 01 02 00 0a 14"));
  EXPECT_EQ(bytes[516], 255);
  EXPECT_EQ(bytes[517], 0xe7);
}

TEST(EnttecCodec, WritesRequestsAsPublished) {
  const std::uint8_t none[] = {0, 0};
  EXPECT_EQ(encode(Label::get_parameters, none), from_hex("7e 03 02 00 00 00 e7"));
  EXPECT_EQ(encode(Label::serial_number, {}), from_hex("7e 0a 00 00 e7"));
  EXPECT_EQ(encode(Label::device_name, {}), from_hex("7e 4e 00 00 e7"));
  EXPECT_EQ(encode_set_parameters({0, 17, 2, 30}), from_hex("7e 04 05 00 00 00 11 02 1e e7"));
}

TEST(EnttecCodec, UnitsAre10Point67Microseconds) {
  EXPECT_EQ(units_of_us(96), 9);
  EXPECT_EQ(units_of_us(11), 1);
  EXPECT_EQ(units_of_us(1355), 127);
  EXPECT_EQ(units_of_us(176), 17);  // 181 µs: nearer than 171
}

TEST(EnttecCodec, ReadsTheAnswersThatOlaReads) {
  StreamDecoder decoder;
  const auto messages = all(decoder, from_hex("7e 0a 04 00 12 34 56 02 e7  7e 03 05 00 44 01 09 01 28 e7"
                                              "7e 4e 05 00 01 00 50 72 6f e7"));
  ASSERT_EQ(messages.size(), 3u);
  EXPECT_EQ(decode_serial(messages[0].data), "02563412");
  const auto parameters = decode_parameters(messages[1].data);
  ASSERT_TRUE(parameters);
  EXPECT_EQ(parameters->firmware, 0x0144);
  EXPECT_EQ(parameters->break_units, 9);
  EXPECT_EQ(parameters->mark_units, 1);
  EXPECT_EQ(parameters->rate_hz, 40);
  EXPECT_EQ(decode_name(messages[2].data), "Pro");
  EXPECT_EQ(decoder.dropped(), 0u);
}

TEST(EnttecCodec, RefusesAnswersCutShortOrOutOfRange) {
  EXPECT_FALSE(decode_serial(from_hex("12 34 56")));
  EXPECT_FALSE(decode_parameters(from_hex("44 01 09 01")));
  EXPECT_FALSE(decode_parameters(from_hex("44 01 08 01 28")));  // break of 8 units
  EXPECT_FALSE(decode_parameters(from_hex("44 01 09 00 28")));
  EXPECT_FALSE(decode_parameters(from_hex("44 01 09 01 29")));  // 41 packets a second
  EXPECT_FALSE(decode_name(from_hex("01")));
  EXPECT_EQ(decode_name(from_hex("01 00 41 07 42 00 43")), "A?B");
}

TEST(EnttecCodec, AcceptsByteWiseMessagesWithDelimitersInTheData) {
  StreamDecoder decoder;
  const auto stream = from_hex("7e 05 04 00 7e e7 7e e7 e7");
  std::vector<Message> messages;
  for (const std::uint8_t byte : stream) {
    const auto some = all(decoder, {byte});
    messages.insert(messages.end(), some.begin(), some.end());
  }
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_EQ(messages[0], (Message{5, from_hex("7e e7 7e e7")}));
}

TEST(EnttecCodec, FindsTheNextMessageAfterNoiseWrongEndOrWrongLength) {
  const auto good = from_hex("7e 0a 04 00 01 02 03 04 e7");
  for (const char* before : {"00 ff e7", "7e 03 05 00 44 01 09 01 28 e6", "7e 03 ff ff", "7e 7e", "7e 7e 03 59 02"}) {
    StreamDecoder decoder;
    auto bytes = from_hex(before);
    bytes.insert(bytes.end(), good.begin(), good.end());
    const auto messages = all(decoder, bytes);
    ASSERT_EQ(messages.size(), 1u) << before;
    EXPECT_EQ(messages[0].data, from_hex("01 02 03 04")) << before;
    EXPECT_EQ(decoder.dropped(), from_hex(before).size()) << before;
  }
}

TEST(EnttecCodec, AGarbledLengthBlocksUntilItIsGivenUp) {
  StreamDecoder decoder;
  const auto stream = from_hex("7e 03 05 02 44 01 09 01 28 e7  7e 0a 04 00 01 02 03 04 e7");  // states 517 bytes
  EXPECT_TRUE(all(decoder, stream).empty());
  decoder.give_up();
  const auto message = decoder.next();
  ASSERT_TRUE(message);
  EXPECT_EQ(message->label, 10);
}

}  // namespace
}  // namespace luxrig::enttec
