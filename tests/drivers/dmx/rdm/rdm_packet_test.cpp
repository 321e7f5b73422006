/// RDM packets against bytes made by another program (OLA), and the contents of parameters.
#include "drivers/dmx/rdm/rdm_packet.h"

#include <gtest/gtest.h>

#include <cmath>

#include "drivers/dmx/rdm/rdm_discovery.h"
#include "drivers/dmx/rdm/rdm_values.h"
#include "tests/drivers/hex.h"

namespace luxrig::rdm {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr Uid kController{0x7a70, 1};

Packet set_address_42() {
  Packet packet;
  packet.to = {0x7a70, 0xffffff02};
  packet.from = kController;
  packet.transaction = 5;
  packet.command_class = CommandClass::set;
  packet.pid = Pid::dmx_start_address;
  packet.data = encode_start_address(42);
  return packet;
}

TEST(RdmPacket, OfAStartAddressMatchesOla) {
  const Bytes bytes = from_hex("cc011a7a70ffffff027a700000000105010000003000f002002a 070d");
  EXPECT_EQ(encode(set_address_42()), bytes);
  const auto packet = decode(bytes);
  ASSERT_TRUE(packet);
  EXPECT_EQ(text_of(packet->to), "7a70:ffffff02");
  EXPECT_EQ(packet->from, kController);
  EXPECT_EQ(packet->transaction, 5);
  EXPECT_EQ(packet->port_or_type, 1);
  EXPECT_EQ(packet->command_class, CommandClass::set);
  EXPECT_EQ(packet->pid, Pid::dmx_start_address);
  EXPECT_EQ(decode_start_address(packet->data), std::optional<int>(42));
}

TEST(RdmPacket, OfDiscoveryMatchesThePublishedBytes) {
  EXPECT_EQ(encode(un_mute_request(kController, 0)), from_hex("cc0118ffffffffffff7a7000000001000100000010000300 07de"));
  EXPECT_EQ(encode(unique_branch_request(kController, 0, uid_of(0), uid_of(0xFFFFFFFFFFFE))),
            from_hex("cc0124ffffffffffff7a700000000100010000001000010c000000000000fffffffffffe 0ded"));
}

TEST(RdmPacket, OfAMovingYokeGivesItsFields) {
  Packet ask;
  ask.to = {0x7a70, 2};
  ask.from = kController;
  ask.transaction = 1;
  EXPECT_EQ(encode(ask), from_hex("cc01187a70000000027a7000000001 01 01 00 0000 20 0060 00 033e"));
  const auto answer = decode(
      from_hex("cc012b7a70000000017a700000000201 00 00 0000 21 0060 13 0100 0005 0102 00000002 0011 01 04 0001 0000 00 "
               "0386"));
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->command_class, response_to(CommandClass::get));
  const auto info = decode_device_info(answer->data);
  ASSERT_TRUE(info);
  EXPECT_EQ(info->model, 5);
  EXPECT_EQ(name_of_category(info->category), "moving head");
  EXPECT_EQ(info->software_version, 2u);
  EXPECT_EQ(info->footprint_slots, 17);
  EXPECT_EQ(info->personality, 1);
  EXPECT_EQ(info->personalities, 4);
  EXPECT_EQ(info->start_address, 1);
  EXPECT_EQ(info->sensors, 0);
}

TEST(RdmPacket, IsRefusedWithAnyChangedByteOrTruncation) {
  const Bytes good = encode(set_address_42());
  for (std::size_t at = 0; at < good.size(); ++at) {
    for (int change = 1; change < 256; ++change) {
      Bytes bytes = good;
      bytes[at] ^= static_cast<std::uint8_t>(change);
      EXPECT_FALSE(decode(bytes)) << at << " " << change;
    }
    EXPECT_FALSE(decode(std::span(good).first(at)));
  }
  Bytes longer = good;
  longer.push_back(0);  // bytes after the packet do not belong to it
  EXPECT_TRUE(decode(longer));
}

TEST(RdmBranchAnswer, MatchesThePublishedBytesAndToleratesAShorterPreamble) {
  const Uid uid{0x7a70, 1};
  const Bytes bytes = from_hex("fefefefefefefeaafa7ffa75aa55aa55aa55ab55ae57eff5");
  EXPECT_EQ(encode_branch_answer(uid), bytes);
  for (std::size_t lost = 0; lost <= 7; ++lost) EXPECT_EQ(decode_branch_answer(std::span(bytes).subspan(lost)), uid);
  EXPECT_FALSE(decode_branch_answer(std::span(bytes).subspan(8)));
  for (std::size_t at = 7; at < bytes.size(); ++at) {
    EXPECT_FALSE(decode_branch_answer(std::span(bytes).first(at)));
    for (int bit = 0; bit < 8; ++bit) {
      Bytes other = bytes;
      other[at] ^= static_cast<std::uint8_t>(1 << bit);
      EXPECT_NE(decode_branch_answer(other), uid);
    }
  }
}

TEST(RdmNames, RoundTrip) {
  EXPECT_EQ(parse_uid("7a70:ffffff02"), (Uid{0x7a70, 0xffffff02}));
  EXPECT_EQ(parse_uid("7A70FFFFFF02"), (Uid{0x7a70, 0xffffff02}));
  for (const char* bad : {"", "7a70", "7a70:ffffff0", "7a70-ffffff02", "7a70:ffffff02x", "g000:00000000"}) {
    EXPECT_FALSE(parse_uid(bad)) << bad;
  }
  for (int number = 0; number < 0x10000; ++number) {
    const auto pid = static_cast<Pid>(number);
    EXPECT_EQ(parse_pid(text_of(pid)), pid);
  }
  EXPECT_EQ(parse_pid("LAMP-HOURS"), Pid::lamp_hours);
  EXPECT_FALSE(parse_pid("lamp"));
  EXPECT_FALSE(parse_pid("0x12345"));
  EXPECT_EQ(text_of_nack(4).substr(0, 17), "write protect (4)");
  EXPECT_EQ(text_of_nack(77), "reason 77, which is not in the standard");
}

TEST(RdmValues, OfASensorHaveItsUnitAndPrefix) {
  // Sensor 2, temperature, °C, deci, range −40.0…150.0, normal 0…65.0, extremes are kept.
  const auto sensor = decode_sensor_definition(from_hex("02 00 01 01 fe70 05dc 0000 028a 02 4c616d70"));
  ASSERT_TRUE(sensor);
  EXPECT_EQ(sensor->number, 2);
  EXPECT_EQ(sensor->range_min, -400);
  EXPECT_EQ(sensor->description, "Lamp");
  EXPECT_TRUE(sensor->records_extremes);
  EXPECT_FALSE(sensor->records_value);
  EXPECT_EQ(text_of(*sensor, 415), "41.5 °C");
  EXPECT_EQ(text_of(*sensor, -5), "-0.5 °C");
  SensorDefinition power;
  power.unit = 0x0A;
  power.prefix = 0x13;
  EXPECT_EQ(text_of(power, 2), "2000 W");
  EXPECT_EQ(exponent_of_prefix(0x03), -3);
  EXPECT_EQ(exponent_of_prefix(0x0A), -24);
  EXPECT_EQ(exponent_of_prefix(0x1A), 24);
  const auto value = decode_sensor_value(from_hex("02 019f fff6 028a 0000"));
  ASSERT_TRUE(value);
  EXPECT_EQ(value->present, 415);
  EXPECT_EQ(value->lowest, -10);
  EXPECT_EQ(value->highest, 650);
}

TEST(RdmValues, OfInvalidFormAreRefused) {
  const Bytes info = from_hex("0100 0005 0102 00000002 0011 01 04 0001 0000 00");
  for (std::size_t size = 0; size < info.size(); ++size) EXPECT_FALSE(decode_device_info(std::span(info).first(size)));
  Bytes none = info;
  none[14] = none[15] = 0xff;
  EXPECT_FALSE(decode_device_info(none)->start_address);
  none[14] = 2;  // 0x02ff is above 512
  EXPECT_FALSE(decode_device_info(none));
  EXPECT_FALSE(decode_start_address(from_hex("0000")));
  EXPECT_FALSE(decode_start_address(from_hex("0201")));
  EXPECT_FALSE(decode_flag(from_hex("02")));
  EXPECT_FALSE(decode_supported_parameters(from_hex("0050 00")));
  EXPECT_FALSE(decode_label(Bytes(33, 'a')));
  EXPECT_EQ(decode_label(from_hex("41 07 42 00 43")), "A?B");
  EXPECT_EQ(decode_hours(from_hex("00010002")), 65538u);
  EXPECT_EQ(text_of(*decode_lamp_state(from_hex("02"))), "strike");
  EXPECT_FALSE(decode_slot_info(from_hex("0000 00 0001 00")));
  const auto fail = decode_fail_mode(from_hex("0000 ffff 0019 80"));
  ASSERT_TRUE(fail);
  EXPECT_TRUE(std::isinf(fail->loss_delay_s));
  EXPECT_DOUBLE_EQ(fail->hold_s, 2.5);
  EXPECT_EQ(describe(Pid::dmx_start_address, from_hex("0000")), "00 00");
  EXPECT_EQ(describe(static_cast<Pid>(0x8001), {}), "no data");
}

}  // namespace
}  // namespace luxrig::rdm
