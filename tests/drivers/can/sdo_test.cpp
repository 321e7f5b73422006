#include <fmt/format.h>
#include <gtest/gtest.h>

#include "drivers/can/canopen/sdo_client.h"
#include "tests/drivers/hex.h"
#include "tests/drivers/test_rig.h"

namespace luxrig::canopen {
namespace {

std::vector<std::uint8_t> of(const SdoBytes& bytes) { return {bytes.begin(), bytes.end()}; }

/// Requests and answers as other decoders read them.
TEST(SdoCodec, FollowsCiA301) {
  EXPECT_EQ(of(encode_download({0x6040, 0}, std::vector<std::uint8_t>{7, 0})), from_hex("2B40600007000000"));
  EXPECT_EQ(of(encode_download({0x607A, 0}, std::vector<std::uint8_t>{0x10, 0x27, 0, 0})),
            from_hex("237A600010270000"));
  EXPECT_EQ(of(encode_download({0x6060, 0}, std::vector<std::uint8_t>{1})), from_hex("2F60600001000000"));
  EXPECT_EQ(of(encode_download({0x1018, 2}, std::vector<std::uint8_t>{1, 2, 3})), from_hex("2718100201020300"));
  EXPECT_EQ(of(encode_upload({0x6041, 0})), from_hex("4041600000000000"));
  EXPECT_EQ(of(encode_upload_segment(false)), from_hex("6000000000000000"));
  EXPECT_EQ(of(encode_upload_segment(true)), from_hex("7000000000000000"));
  EXPECT_EQ(of(encode_abort({0x1008, 0}, kAbortTimeout)), from_hex("8008100000000405"));
}

TEST(SdoCodec, DecodesEveryAnswer) {
  SdoAnswer answer = decode_sdo_answer(from_hex("6040600000000000"));
  EXPECT_EQ(answer.kind, SdoAnswerKind::downloaded);
  EXPECT_EQ(answer.object, (ObjectAddress{0x6040, 0}));

  answer = decode_sdo_answer(from_hex("4B41600037120000"));
  EXPECT_EQ(answer.kind, SdoAnswerKind::uploaded);
  EXPECT_EQ(answer.object, (ObjectAddress{0x6041, 0}));
  EXPECT_EQ(answer.bytes, from_hex("3712"));
  EXPECT_EQ(decode_sdo_answer(from_hex("4F61600006000000")).bytes, from_hex("06"));
  EXPECT_EQ(decode_sdo_answer(from_hex("4761600006050400")).bytes, from_hex("060504"));
  EXPECT_EQ(decode_sdo_answer(from_hex("4364600010270000")).bytes, from_hex("10270000"));
  EXPECT_EQ(decode_sdo_answer(from_hex("4264600010270000")).bytes.size(), 4u) << "no size given: all four";

  answer = decode_sdo_answer(from_hex("4108100018000000"));
  EXPECT_EQ(answer.kind, SdoAnswerKind::started);
  EXPECT_EQ(answer.size, 24u);
  EXPECT_EQ(decode_sdo_answer(from_hex("4008100018000000")).size, 0u);

  answer = decode_sdo_answer(from_hex("0041424344454647"));
  EXPECT_EQ(answer.kind, SdoAnswerKind::segment);
  EXPECT_EQ(answer.bytes, from_hex("41424344454647"));
  EXPECT_FALSE(answer.toggle);
  EXPECT_FALSE(answer.last);
  answer = decode_sdo_answer(from_hex("1B41420000000000"));  // toggle, five unused, last
  EXPECT_EQ(answer.bytes, from_hex("4142"));
  EXPECT_TRUE(answer.toggle);
  EXPECT_TRUE(answer.last);

  answer = decode_sdo_answer(from_hex("80FE600000000206"));
  EXPECT_EQ(answer.kind, SdoAnswerKind::aborted);
  EXPECT_EQ(answer.abort_code, 0x06020000u);
  EXPECT_EQ(abort_text(answer.abort_code), "object does not exist (06020000)");
  EXPECT_EQ(abort_text(0x12345678), "unknown reason (12345678)");

  EXPECT_EQ(decode_sdo_answer(from_hex("E000000000000000")).kind, SdoAnswerKind::garbled);
  EXPECT_EQ(decode_sdo_answer(from_hex("604060000000")).kind, SdoAnswerKind::garbled);
  EXPECT_EQ(decode_sdo_answer({}).kind, SdoAnswerKind::garbled);
}

can::CanFrame answer_of(std::string_view hex) { return can::data_frame(0x585, from_hex(hex)); }

std::string sent_by(SdoClient& client, Time now) {
  const auto frame = client.to_send(now);
  if (!frame) return "";
  EXPECT_EQ(frame->id, 0x605u);
  std::string text;
  for (const std::uint8_t byte : frame->payload()) text += fmt::format("{:02X}", byte);
  return text;
}

TEST(SdoClient, CompletesAWriteOnItsOwnAnswer) {
  SdoClient client(5);
  client.start({{0x6040, 0}, {7, 0}});
  EXPECT_EQ(sent_by(client, at_ms(0)), "2B40600007000000");
  EXPECT_EQ(sent_by(client, at_ms(499)), "");
  client.receive(answer_of("4B40600007000000"));  // an answer to a read
  client.receive(answer_of("6041600000000000"));  // for another object
  client.receive(answer_of("604060"));
  EXPECT_FALSE(client.take_result());
  client.receive(answer_of("6040600000000000"));
  const auto result = client.take_result();
  ASSERT_TRUE(result && result->has_value());
  EXPECT_TRUE((*result)->empty());
  EXPECT_TRUE(client.idle());
  EXPECT_EQ(sent_by(client, at_ms(5000)), "");
}

TEST(SdoClient, RepeatsTwiceThenGivesUpWithAReport) {
  SdoClient client(5);
  client.start({{0x1000, 0}, {}});
  EXPECT_EQ(sent_by(client, at_ms(0)), "4000100000000000");
  EXPECT_EQ(sent_by(client, at_ms(500)), "4000100000000000");
  EXPECT_EQ(sent_by(client, at_ms(1000)), "4000100000000000");
  EXPECT_FALSE(client.take_result());
  EXPECT_EQ(sent_by(client, at_ms(1500)), "8000100000000405");
  const auto result = client.take_result();
  ASSERT_TRUE(result && !result->has_value());
  EXPECT_FALSE(result->error().abort_code);
  client.receive(answer_of("4300100092010200"));  // too late
  EXPECT_FALSE(client.take_result());
}

TEST(SdoClient, ReadsInSegments) {
  SdoClient client(5);
  client.start({{0x1008, 0}, {}});
  (void)sent_by(client, at_ms(0));
  client.receive(answer_of("4108100009000000"));
  EXPECT_EQ(sent_by(client, at_ms(1)), "6000000000000000");
  client.receive(answer_of("0041424344454647"));
  EXPECT_EQ(sent_by(client, at_ms(2)), "7000000000000000");
  client.receive(answer_of("1B48490000000000"));
  const auto result = client.take_result();
  ASSERT_TRUE(result && result->has_value());
  EXPECT_EQ(std::string((*result)->begin(), (*result)->end()), "ABCDEFGHI");
}

TEST(SdoClient, RestartsWhenASegmentIsLost) {
  SdoClient client(5);
  client.start({{0x1008, 0}, {}});
  (void)sent_by(client, at_ms(0));
  client.receive(answer_of("4108100009000000"));
  EXPECT_EQ(sent_by(client, at_ms(1)), "6000000000000000");
  EXPECT_EQ(sent_by(client, at_ms(600)), "4008100000000000");
  client.receive(answer_of("4108100009000000"));
  EXPECT_EQ(sent_by(client, at_ms(601)), "6000000000000000");
}

TEST(SdoClient, AbortsATransferWithAWrongToggleBitOrWithoutEnd) {
  SdoClient wrong(5);
  wrong.start({{0x1008, 0}, {}});
  (void)sent_by(wrong, at_ms(0));
  wrong.receive(answer_of("4108100009000000"));
  (void)sent_by(wrong, at_ms(1));
  wrong.receive(answer_of("1041424344454647"));
  EXPECT_EQ(sent_by(wrong, at_ms(2)), "8008100000000305");
  EXPECT_EQ(wrong.take_result()->error().abort_code, kAbortToggle);

  SdoClient endless(5);
  endless.start({{0x1008, 0}, {}});
  (void)sent_by(endless, at_ms(0));
  endless.receive(answer_of("4008100000000000"));
  int segments = 0;
  for (bool toggle = false; !endless.idle() && segments < 1000; toggle = !toggle, ++segments) {
    (void)sent_by(endless, at_ms(1));
    endless.receive(answer_of(toggle ? "1041424344454647" : "0041424344454647"));
  }
  EXPECT_EQ(segments, 147) << "1 024 bytes in sevens";
  EXPECT_EQ(endless.take_result()->error().abort_code, kAbortOutOfMemory);
}

}  // namespace
}  // namespace luxrig::canopen
