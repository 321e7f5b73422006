// NMT, heartbeat, emergency messages, PDO set-up and the drive's state machine, against bytes decoded by other
// programs.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <linux/can.h>

#include <cstring>

#include "drivers/can/bus_state.h"
#include "drivers/can/canopen/emergency.h"
#include "drivers/can/canopen/nmt.h"
#include "drivers/can/canopen/pdo_setup.h"
#include "drivers/can/cia402/drive_state.h"
#include "drivers/can/cia402/set_point.h"
#include "tests/drivers/hex.h"
#include "tests/drivers/test_rig.h"

namespace luxrig {
namespace {

using can::CanFrame;

/// As candump prints it: "605#2B40600007000000".
std::string text_of(const CanFrame& frame) {
  std::string text = fmt::format("{:03X}#", frame.id);
  for (const std::uint8_t byte : frame.payload()) text += fmt::format("{:02X}", byte);
  return text;
}

TEST(CanFrame, HasTheKernelsLayout) {
  const CanFrame frame = can::data_frame(0x605, from_hex("2B40600007000000"));
  ::can_frame kernel{};
  kernel.can_id = 0x605;
  kernel.can_dlc = 8;
  std::memcpy(kernel.data, "\x2B\x40\x60\x00\x07\x00\x00\x00", 8);
  const auto bytes = to_bytes(frame);
  EXPECT_EQ(std::memcmp(bytes.data(), &kernel, sizeof kernel), 0);
  EXPECT_EQ(text_of(*can::from_bytes(bytes)), "605#2B40600007000000");

  kernel.can_id = CAN_ERR_FLAG | 0x40;
  std::array<std::uint8_t, 16> raw{};
  std::memcpy(raw.data(), &kernel, sizeof kernel);
  EXPECT_TRUE(can::from_bytes(raw)->error);
  EXPECT_EQ(can::from_bytes(raw)->id, 0x40u);
  raw[4] = 9;
  EXPECT_FALSE(can::from_bytes(raw));
  EXPECT_FALSE(can::from_bytes(from_hex("0102")));
}

CanFrame error_of(std::uint32_t classes, int controller = 0) {
  CanFrame frame;
  frame.error = true;
  frame.id = classes;
  frame.size = 8;
  frame.data[1] = static_cast<std::uint8_t>(controller);
  return frame;
}

TEST(BusState, FollowsTheControllersErrorFrames) {
  using can::ControllerState;
  can::BusState state;
  EXPECT_EQ(state.state(), ControllerState::active);
  state.heard(error_of(0x204, 0x04));  // as slcan sends it, with counters
  EXPECT_EQ(state.state(), ControllerState::warning);
  state.heard(error_of(0x204, 0x10));
  EXPECT_EQ(state.state(), ControllerState::passive);
  state.heard(error_of(0x204, 0x40));
  EXPECT_EQ(state.state(), ControllerState::active);
  state.heard(error_of(0x204, 0x20));
  EXPECT_EQ(state.state(), ControllerState::passive);
  state.heard(error_of(0x40));
  EXPECT_EQ(state.state(), ControllerState::off);
  state.heard(error_of(0x100));
  EXPECT_EQ(state.state(), ControllerState::active);
  state.heard(error_of(0x40));
  state.heard(can::data_frame(0x705, from_hex("05")));  // heard without any sign of the restart
  EXPECT_EQ(state.state(), ControllerState::active);
  state.heard(error_of(0x204, 0x10));
  state.heard(can::data_frame(0x705, from_hex("05")));
  EXPECT_EQ(state.state(), ControllerState::passive) << "a passive controller hears, too";
  EXPECT_EQ(state.overruns(), 0u);
  state.heard(error_of(0x04, 0x01));
  EXPECT_EQ(state.overruns(), 1u);
}

TEST(Nmt, CommandsAndHeartbeatsFollowTheStandard) {
  using namespace canopen;
  EXPECT_EQ(text_of(nmt_frame(NmtCommand::start, 5)), "000#0105");
  EXPECT_EQ(text_of(nmt_frame(NmtCommand::pre_operational, 127)), "000#807F");
  EXPECT_EQ(text_of(nmt_frame(NmtCommand::reset_node, 0)), "000#8100");
  EXPECT_EQ(text_of(heartbeat_frame(NmtState::operational, 5)), "705#05");
  EXPECT_EQ(decode_heartbeat(can::data_frame(0x705, from_hex("05"))), NmtState::operational);
  EXPECT_EQ(decode_heartbeat(can::data_frame(0x705, from_hex("00"))), NmtState::boot_up);
  EXPECT_EQ(decode_heartbeat(can::data_frame(0x705, from_hex("7F"))), NmtState::pre_operational);
  EXPECT_EQ(decode_heartbeat(can::data_frame(0x705, from_hex("04"))), NmtState::stopped);
  EXPECT_FALSE(decode_heartbeat(can::data_frame(0x705, from_hex("85"))));
  EXPECT_FALSE(decode_heartbeat(can::data_frame(0x705, from_hex("0505"))));
  EXPECT_FALSE(decode_heartbeat(can::data_frame(0x705, {})));
}

TEST(Nmt, AHeartbeatCountsAsMissedAfterItsTimeout) {
  canopen::HeartbeatConsumer consumer(std::chrono::milliseconds(300));
  EXPECT_FALSE(consumer.state(at_ms(0)));
  consumer.heard(at_ms(0), canopen::NmtState::operational);
  EXPECT_TRUE(consumer.state(at_ms(300)));
  EXPECT_FALSE(consumer.state(at_ms(301)));
}

TEST(Emergency, IsDecodedAndNamed) {
  const auto message = canopen::decode_emergency(can::data_frame(0x085, from_hex("1186200102030405")));
  ASSERT_TRUE(message);
  EXPECT_EQ(message->code, 0x8611);
  EXPECT_EQ(message->error_register, 0x20);
  EXPECT_EQ(message->of_maker[4], 5);
  EXPECT_EQ(canopen::error_text(0x8611), "following error (8611)");
  EXPECT_EQ(canopen::error_text(0x8130), "heartbeat of the master lost (8130)");
  EXPECT_EQ(canopen::error_text(0x2399), "current (2399)");
  EXPECT_EQ(canopen::error_text(0xFF01), "its maker's own (FF01)");
  EXPECT_EQ(canopen::error_text(0x0042), "unknown error (0042)");
  EXPECT_FALSE(canopen::decode_emergency(can::data_frame(0x085, from_hex("118620"))));
}

std::string text_of(const canopen::SdoRequest& request) {
  std::string text = canopen::text_of(request.object) + "=";
  for (const std::uint8_t byte : request.value) text += fmt::format("{:02X}", byte);
  return text;
}

TEST(PdoSetup, FollowsTheOrderThatNodesRequire) {
  const auto writes =
      canopen::pdo_setup(canopen::PdoDirection::to_node, 1, 5, 1, {{{0x6040, 0}, 16}, {{0x607A, 0}, 32}});
  std::vector<std::string> texts;
  for (const auto& write : writes) texts.push_back(text_of(write));
  EXPECT_EQ(texts, (std::vector<std::string>{"1400:1=05020080", "1600:0=00", "1600:1=10004060", "1600:2=20007A60",
                                             "1600:0=02", "1400:2=01", "1400:1=05020000"}));
  EXPECT_EQ(text_of(canopen::pdo_setup(canopen::PdoDirection::from_node, 2, 5, 1, {}).front()), "1801:1=85020080");
}

TEST(DriveState, IsReadFromEveryStatusword) {
  using cia402::DriveState;
  struct Row {
    int mask, value;
    DriveState state;
  };
  // CiA 402-2, table 30.
  const Row table[] = {{0x4F, 0x00, DriveState::not_ready_to_switch_on}, {0x4F, 0x40, DriveState::switch_on_disabled},
                       {0x6F, 0x21, DriveState::ready_to_switch_on},     {0x6F, 0x23, DriveState::switched_on},
                       {0x6F, 0x27, DriveState::operation_enabled},      {0x6F, 0x07, DriveState::quick_stop_active},
                       {0x4F, 0x0F, DriveState::fault_reaction_active},  {0x4F, 0x08, DriveState::fault}};
  for (int word = 0; word <= 0xFFFF; ++word) {
    DriveState wanted = DriveState::unknown;
    int rows = 0;
    for (const Row& row : table) {
      if ((word & row.mask) != row.value) continue;
      wanted = row.state;
      ++rows;
    }
    ASSERT_LE(rows, 1) << word;
    ASSERT_EQ(cia402::state_of(static_cast<std::uint16_t>(word)), wanted) << word;
  }
}

TEST(DriveState, EachStateIsLeftByItsControlword) {
  using cia402::DriveState, cia402::towards_operation;
  EXPECT_EQ(towards_operation(DriveState::switch_on_disabled, true), 0x0006);
  EXPECT_EQ(towards_operation(DriveState::ready_to_switch_on, true), 0x0007);
  EXPECT_EQ(towards_operation(DriveState::switched_on, true), 0x000F);
  EXPECT_EQ(towards_operation(DriveState::operation_enabled, true), 0x000F);
  EXPECT_EQ(towards_operation(DriveState::quick_stop_active, true), 0x000F);
  EXPECT_EQ(towards_operation(DriveState::quick_stop_active, false), 0x0000);
  for (const DriveState state :
       {DriveState::not_ready_to_switch_on, DriveState::fault_reaction_active, DriveState::fault, DriveState::unknown})
    EXPECT_EQ(towards_operation(state, true), 0x0000) << name_of(state);
}

TEST(SetPoint, IsOfferedUntilAcknowledgedAndTheNewestFollows) {
  cia402::SetPointHandshake handshake;
  constexpr std::uint16_t kEnabled = 0x0637, kAcknowledged = 0x1637;
  EXPECT_EQ(handshake.step(at_ms(0), kEnabled, true), 0x002F);
  EXPECT_FALSE(handshake.current());
  handshake.order({100, 10, 20});
  EXPECT_EQ(handshake.step(at_ms(20), kEnabled, true), 0x002F) << "limits first";
  EXPECT_TRUE(handshake.limits_due());
  EXPECT_EQ(handshake.step(at_ms(40), kEnabled, true), 0x003F);
  handshake.order({200, 10, 20});
  handshake.order({300, 10, 20});
  EXPECT_EQ(handshake.step(at_ms(60), kEnabled, true), 0x003F);
  EXPECT_EQ(handshake.step(at_ms(80), kAcknowledged, false), 0x003F) << "an old word";
  EXPECT_EQ(handshake.step(at_ms(100), kAcknowledged, true), 0x002F);
  EXPECT_EQ(handshake.current()->position, 100);
  EXPECT_EQ(handshake.step(at_ms(120), kAcknowledged, true), 0x002F);
  EXPECT_FALSE(handshake.idle());
  EXPECT_EQ(handshake.step(at_ms(140), kEnabled, true), 0x002F);
  EXPECT_EQ(handshake.step(at_ms(160), kEnabled, true), 0x002F);
  EXPECT_EQ(handshake.current()->position, 300);
  EXPECT_EQ(handshake.step(at_ms(180), kEnabled, true), 0x003F);
  for (int ms = 200; ms < 680; ms += 20) EXPECT_EQ(handshake.step(at_ms(ms), kEnabled, true), 0x003F) << ms;
  EXPECT_EQ(handshake.step(at_ms(680), kEnabled, true), 0x002F) << "offered anew";
  EXPECT_EQ(handshake.step(at_ms(700), kEnabled, true), 0x003F);
}

}  // namespace
}  // namespace luxrig
