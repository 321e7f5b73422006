/// One question to a scripted device: which requests are sent when, and how answers are interpreted.
#include "drivers/dmx/rdm/rdm_transaction.h"

#include <gtest/gtest.h>

#include "tests/drivers/hex.h"
#include "tests/drivers/test_rig.h"

namespace luxrig::rdm {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr Uid kSelf{0x7ff0, 9}, kDevice{0x7a70, 1};

struct Talk {
  explicit Talk(Pid pid, CommandClass command_class = CommandClass::get, Uid to = kDevice, Bytes data = {})
      : transaction({to, command_class, pid, std::move(data)}, kSelf, number, {}) {}

  /// Request sent at that time; empty if none.
  std::optional<Packet> due(double ms) {
    auto packet = transaction.due(at_ms(ms));
    if (packet) last = *packet;
    return packet;
  }
  void hear(double ms, ResponseType type, Bytes data, std::optional<Pid> pid = {}, std::uint8_t messages = 0) {
    transaction.hear(at_ms(ms), answer(type, std::move(data), pid, messages));
  }
  Packet answer(ResponseType type, Bytes data, std::optional<Pid> pid = {}, std::uint8_t messages = 0) const {
    Packet packet = last;
    std::swap(packet.to, packet.from);
    packet.command_class = response_to(last.command_class);
    packet.port_or_type = static_cast<std::uint8_t>(type);
    packet.message_count = messages;
    packet.pid = pid.value_or(last.pid);
    packet.data = std::move(data);
    return packet;
  }
  [[nodiscard]] bool answered(const Bytes& data) const {
    return transaction.result() && *transaction.result() && **transaction.result() == data;
  }
  [[nodiscard]] Fault fault() const {
    return transaction.result() && !*transaction.result() ? transaction.result()->error() : Fault{};
  }

  std::uint8_t number = 0;
  Transaction transaction;
  Packet last;
};

TEST(RdmTransaction, EndsWithItsAnswer) {
  Talk talk(Pid::device_hours);
  const auto sent = talk.due(0);
  ASSERT_TRUE(sent);
  EXPECT_EQ(sent->to, kDevice);
  EXPECT_EQ(sent->from, kSelf);
  EXPECT_EQ(sent->pid, Pid::device_hours);
  EXPECT_FALSE(talk.due(1));
  talk.hear(5, ResponseType::ack, {0, 0, 0, 7});
  EXPECT_TRUE(talk.answered({0, 0, 0, 7}));
  EXPECT_FALSE(talk.due(1000));
}

TEST(RdmTransaction, GivesUpAfterThreeRequests) {
  Talk talk(Pid::device_hours);
  ASSERT_TRUE(talk.due(0));
  EXPECT_FALSE(talk.due(299));
  ASSERT_TRUE(talk.due(300));
  ASSERT_TRUE(talk.due(600));
  EXPECT_EQ(talk.last.transaction, 3);
  EXPECT_FALSE(talk.due(899));
  EXPECT_FALSE(talk.transaction.result());
  EXPECT_FALSE(talk.due(900));
  EXPECT_EQ(talk.fault().cause, Cause::timeout);
  EXPECT_EQ(talk.fault().device, "7a70:00000001");
}

TEST(RdmTransaction, AcceptsTheAnswerToItsSecondRequest) {
  Talk talk(Pid::device_hours);
  ASSERT_TRUE(talk.due(0));
  ASSERT_TRUE(talk.due(300));
  talk.hear(310, ResponseType::ack, {1, 2, 3, 4});
  EXPECT_TRUE(talk.answered({1, 2, 3, 4}));
}

TEST(RdmTransaction, IgnoresForeignAnswers) {
  Talk talk(Pid::device_hours);
  ASSERT_TRUE(talk.due(0));
  const Packet good = talk.answer(ResponseType::ack, {0, 0, 0, 7});
  const auto ignored = [&](auto change) {
    Packet packet = good;
    change(packet);
    talk.transaction.hear(at_ms(1), packet);
    return !talk.transaction.result();
  };
  EXPECT_TRUE(ignored([](Packet& packet) { packet.from.device = 2; }));
  EXPECT_TRUE(ignored([](Packet& packet) { packet.to.device = 8; }));
  EXPECT_TRUE(ignored([](Packet& packet) { ++packet.transaction; }));
  EXPECT_TRUE(ignored([](Packet& packet) { packet.pid = Pid::lamp_hours; }));
  EXPECT_TRUE(ignored([](Packet& packet) { packet.command_class = CommandClass::set_response; }));
  EXPECT_TRUE(ignored([](Packet& packet) { packet.command_class = CommandClass::get; }));
  EXPECT_TRUE(ignored([](Packet& packet) { packet.sub_device = 1; }));
  EXPECT_FALSE(ignored([](Packet&) {}));
}

TEST(RdmTransaction, ReportsTheReasonOfANack) {
  Talk talk(Pid::dmx_start_address, CommandClass::set, kDevice, {0, 1});
  ASSERT_TRUE(talk.due(0));
  talk.hear(1, ResponseType::nack, {0, 4});
  EXPECT_EQ(talk.fault().cause, Cause::refused);
  EXPECT_EQ(talk.fault().detail, "dmx_start_address: " + text_of_nack(4));
}

TEST(RdmTransaction, WaitsForTheAckTimerAndThenPollsTheQueue) {
  Talk talk(Pid::lamp_hours);
  ASSERT_TRUE(talk.due(0));
  talk.hear(1, ResponseType::ack_timer, {0, 5});
  EXPECT_FALSE(talk.due(400));
  EXPECT_FALSE(talk.due(500.5));
  ASSERT_TRUE(talk.due(502));
  EXPECT_EQ(talk.last.pid, Pid::queued_message);
  EXPECT_EQ(talk.last.data, Bytes{2});
  talk.hear(503, ResponseType::ack, {1, 2}, Pid::dmx_start_address, 1);  // another message arrived first
  EXPECT_FALSE(talk.transaction.result());
  ASSERT_TRUE(talk.due(504));
  EXPECT_EQ(talk.last.pid, Pid::queued_message);
  talk.hear(505, ResponseType::ack, {0, 0, 1, 0}, Pid::lamp_hours);
  EXPECT_TRUE(talk.answered({0, 0, 1, 0}));
}

TEST(RdmTransaction, RequestsTheLastMessageWhenAQueuedAnswerWasLost) {
  Talk talk(Pid::lamp_hours);
  ASSERT_TRUE(talk.due(0));
  talk.hear(1, ResponseType::ack_timer, {0, 1});
  ASSERT_TRUE(talk.due(102));
  ASSERT_TRUE(talk.due(403));  // no answer
  EXPECT_EQ(talk.last.data, Bytes{1});
  talk.hear(404, ResponseType::ack, {0, 0, 1, 0}, Pid::lamp_hours);
  EXPECT_TRUE(talk.answered({0, 0, 1, 0}));
}

TEST(RdmTransaction, RepeatsTheRequestWithoutAQueueOrWithAnEmptyOne) {
  Talk none(Pid::lamp_hours);
  ASSERT_TRUE(none.due(0));
  none.hear(1, ResponseType::ack_timer, {0, 1});
  ASSERT_TRUE(none.due(102));
  none.hear(103, ResponseType::nack, {0, 0});
  ASSERT_TRUE(none.due(104));
  EXPECT_EQ(none.last.pid, Pid::lamp_hours);

  Talk empty(Pid::lamp_hours);
  ASSERT_TRUE(empty.due(0));
  empty.hear(1, ResponseType::ack_timer, {0, 1});
  ASSERT_TRUE(empty.due(102));
  empty.hear(103, ResponseType::ack, {}, Pid::status_messages);
  ASSERT_TRUE(empty.due(104));
  EXPECT_EQ(empty.last.data, Bytes{1});
  empty.hear(105, ResponseType::ack, {}, Pid::status_messages);
  ASSERT_TRUE(empty.due(106));
  EXPECT_EQ(empty.last.pid, Pid::lamp_hours);
  empty.hear(107, ResponseType::ack, {0, 0, 0, 1});
  EXPECT_TRUE(empty.answered({0, 0, 0, 1}));
}

TEST(RdmTransaction, DoesNotWaitForEndlessTimers) {
  Talk longer(Pid::lamp_hours);
  ASSERT_TRUE(longer.due(0));
  longer.hear(1, ResponseType::ack_timer, {0xff, 0xff});
  EXPECT_EQ(longer.fault().cause, Cause::timeout);

  Talk again(Pid::lamp_hours);
  int sent = 0;
  for (double ms = 0; ms < 20000 && !again.transaction.result(); ms += 1) {
    if (!again.due(ms)) continue;
    ++sent;
    again.hear(ms, ResponseType::ack_timer, {0, 0});
  }
  EXPECT_EQ(again.fault().cause, Cause::timeout);
  EXPECT_LE(sent, 10002);  // one in each step of 1 ms, the caller's pace, for 10 s
}

TEST(RdmTransaction, CollectsPartsAndRestartsWhenOneIsLost) {
  Talk talk(Pid::slot_info);
  ASSERT_TRUE(talk.due(0));
  talk.hear(1, ResponseType::ack_overflow, {1, 2});
  ASSERT_TRUE(talk.due(2));
  EXPECT_EQ(talk.last.pid, Pid::slot_info);
  talk.hear(3, ResponseType::ack_overflow, {3});
  ASSERT_TRUE(talk.due(4));
  ASSERT_TRUE(talk.due(304));  // the third part is lost
  EXPECT_EQ(talk.last.pid, Pid::device_info);
  talk.hear(305, ResponseType::ack, Bytes(19, 0));
  ASSERT_TRUE(talk.due(306));
  EXPECT_EQ(talk.last.pid, Pid::slot_info);
  talk.hear(307, ResponseType::ack_overflow, {1, 2, 3});
  ASSERT_TRUE(talk.due(308));
  talk.hear(309, ResponseType::ack, {4});
  EXPECT_TRUE(talk.answered({1, 2, 3, 4}));
}

TEST(RdmTransaction, EndsAnEndlessAnswer) {
  Talk talk(Pid::slot_info);
  for (int i = 0; i < 1000 && !talk.transaction.result(); ++i) {
    ASSERT_TRUE(talk.due(i));
    talk.hear(i, ResponseType::ack_overflow, Bytes(231, 1));
  }
  EXPECT_EQ(talk.fault().cause, Cause::protocol);
}

TEST(RdmTransaction, TreatsUndefinedAnswerTypesAsAFault) {
  for (const int type : {1, 2, 4, 255}) {
    Talk talk(Pid::device_hours);
    ASSERT_TRUE(talk.due(0));
    talk.hear(1, static_cast<ResponseType>(type), {0});
    EXPECT_EQ(talk.fault().cause, Cause::protocol) << type;
  }
}

TEST(RdmTransaction, EndsABroadcastOnceItIsSent) {
  Talk talk(Pid::identify_device, CommandClass::set, kEverybody, {0});
  ASSERT_TRUE(talk.due(0));
  EXPECT_TRUE(talk.answered({}));
}

}  // namespace
}  // namespace luxrig::rdm
