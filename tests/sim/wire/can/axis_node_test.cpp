// The simulated node against literal frames of CiA 301, as candump prints them.
#include "sim/wire/can/axis_node.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/drivers/hex.h"

namespace luxrig::sim {
namespace {

using std::chrono::milliseconds;

struct Node : AxisNode {
  Node() : AxisNode(5, {}, 0, 200) { set_power(now, true); }
  /// Sends "605#40…"; returns the answers, separated by blanks.
  std::string answer(std::string_view frame) {
    const auto payload = from_hex(frame.substr(4));
    receive(now,
            bus_frame(static_cast<std::uint32_t>(std::stoul(std::string(frame.substr(0, 3)), nullptr, 16)), payload));
    return said();
  }
  std::string said() {
    std::string text;
    for (const BusFrame& frame : take_sent()) {
      text += fmt::format("{}{:03X}#", text.empty() ? "" : " ", frame.id);
      for (std::size_t i = 0; i < frame.size; ++i) text += fmt::format("{:02X}", frame.data[i]);
    }
    return text;
  }
  std::string run(int ms) {
    for (int i = 0; i < ms; ++i) {
      now += milliseconds(1);
      step(now, false);
    }
    return said();
  }
  Time now{};
};

TEST(AxisNode, BootsAndObeysNmt) {
  Node node;
  EXPECT_EQ(node.said(), "705#00");
  EXPECT_EQ(node.answer("605#2B171000640000 00"), "585#6017100000000000");
  EXPECT_EQ(node.run(1), "705#7F");
  EXPECT_EQ(node.run(100), "705#7F");
  EXPECT_EQ(node.answer("000#0105"), "");
  EXPECT_EQ(node.run(100), "705#05");
  EXPECT_EQ(node.answer("000#0206"), "") << "another's";
  EXPECT_EQ(node.run(100), "705#05");
  EXPECT_EQ(node.answer("000#0200"), "");
  EXPECT_EQ(node.run(100), "705#04");
  EXPECT_EQ(node.answer("605#4000100000000000"), "") << "no SDO while stopped";
  EXPECT_EQ(node.answer("000#8105"), "705#00");
  EXPECT_EQ(node.run(300), "") << "it has forgotten the heartbeat";
}

TEST(AxisNode, ReadsAndWritesObjectsAndExplainsRefusals) {
  Node node;
  (void)node.said();
  EXPECT_EQ(node.answer("605#4000100000000000"), "585#4300100092010200");
  EXPECT_EQ(node.answer("605#4061600000000000"), "585#4F61600000000000");
  EXPECT_EQ(node.answer("605#4041600000000000"), "585#4B41600050060000")
      << "switch on disabled, remote, voltage, at its target";
  EXPECT_EQ(node.answer("605#237A600010270000"), "585#607A600000000000");
  EXPECT_EQ(node.answer("605#407A600000000000"), "585#437A600010270000");
  EXPECT_EQ(node.answer("605#40FE600000000000"), "585#80FE600000000206") << "no object";
  EXPECT_EQ(node.answer("605#407D600300000000"), "585#807D600311000906") << "no sub-index";
  EXPECT_EQ(node.answer("605#2B41600000000000"), "585#8041600002000106") << "read only";
  EXPECT_EQ(node.answer("605#2B7A600010270000"), "585#807A600010000706") << "wrong length";
  EXPECT_EQ(node.answer("605#2F60600009000000"), "585#8060600030000906") << "out of range";
  EXPECT_EQ(node.answer("605#217A600004000000"), "585#807A600001000405") << "segmented download";
  EXPECT_EQ(node.answer("605#6000000000000000"), "585#8008100001000405") << "a segment of nothing";
  EXPECT_EQ(node.answer("605#40"), "");
}

TEST(AxisNode, SendsItsNameInSegments) {
  Node node;
  (void)node.said();
  EXPECT_EQ(node.answer("605#4008100000000000"), "585#410810000E000000");
  EXPECT_EQ(node.answer("605#6000000000000000"), "585#0053696D756C6174");  // Simulat
  EXPECT_EQ(node.answer("605#7000000000000000"), "585#1165642061786973");  // ed axis
  (void)node.answer("605#4008100000000000");
  EXPECT_EQ(node.answer("605#7000000000000000"), "585#8008100000000305") << "toggle bit";
}

/// As a master maps RPDO 1 and TPDO 1.
void map_pdos(Node& node) {
  (void)node.said();
  for (const char* write :
       {"605#2300140105020080", "605#2F00160000000000", "605#2300160110004060", "605#230016022000 7A60",
        "605#2F00160002000000", "605#2F00140201000000", "605#2300140105020000", "605#2300180185010080",
        "605#2F001A0000000000", "605#23001A0110004160", "605#23001A0220006460", "605#23001A0308006160",
        "605#2F001A0003000000", "605#2F00180201000000", "605#2300180185010000"}) {
    EXPECT_EQ(node.answer(write).substr(0, 6), "585#60") << write;
  }
}

TEST(AxisNode, MapsItsPdosOnlyInTheRightOrder) {
  Node node;
  (void)node.said();
  EXPECT_EQ(node.answer("605#2300140105020000").substr(0, 6), "585#60");
  EXPECT_EQ(node.answer("605#2F00160000000000"), "585#8000160022000008") << "while it is on";
  EXPECT_EQ(node.answer("605#2300140105020080").substr(0, 6), "585#60");
  EXPECT_EQ(node.answer("605#2F00160000000000").substr(0, 6), "585#60");
  EXPECT_EQ(node.answer("605#2300160110004160"), "585#8000160141000406") << "a statusword is not taken";
  EXPECT_EQ(node.answer("605#2300160120004060"), "585#8000160141000406") << "not of that size";
  EXPECT_EQ(node.answer("605#2F00160001000000"), "585#8000160041000406") << "an entry that was never set";
  for (int sub = 1; sub <= 3; ++sub)
    EXPECT_EQ(node.answer(fmt::format("605#2300160{}20007A60", sub)).substr(0, 6), "585#60");
  EXPECT_EQ(node.answer("605#2F00160003000000"), "585#8000160042000406") << "96 bits";
  (void)node.answer("000#0105");
  EXPECT_EQ(node.answer("605#2300140105020000"), "585#8000140122000008") << "not while operational";
}

/// RPDO 2 off, no entries, then 6081:32 as its first and the number of entries.
TEST(AxisNode, RefusesAnUnmappableMappingWithTheGivenCode) {
  struct Refusal {
    std::uint32_t code;
    const char* entry;
    const char* count;  ///< answer to a count of one, if the entry was accepted
  };
  for (const Refusal& refusal : {Refusal{kNotMappable, "585#8001160141000406", "585#8001160041000406"},
                                 Refusal{kPdoTooLong, "585#6001160100000000", "585#8001160042000406"},
                                 Refusal{kOutOfRange, "585#8001160130000906", "585#8001160041000406"}}) {
    Node node;
    node.refuse_limits_in_pdos(refusal.code);
    node.reset(node.now);
    (void)node.said();
    EXPECT_EQ(node.answer("605#2301140105030080"), "585#6001140100000000");
    EXPECT_EQ(node.answer("605#2F01160000000000"), "585#6001160000000000");
    EXPECT_EQ(node.answer("605#2301160120008160"), refusal.entry);
    EXPECT_EQ(node.answer("605#2F01160001000000"), refusal.count);
    EXPECT_EQ(node.answer("605#2381600088130000"), "585#6081600000000000") << "by SDO it is taken";
    EXPECT_EQ(node.answer("605#2301160120007A60"), "585#6001160100000000") << "a target can be mapped";
    node.refuse_limits_in_pdos(std::nullopt);
    EXPECT_EQ(node.answer("605#2301160120008160"), "585#6001160100000000");
    EXPECT_EQ(node.answer("605#2F01160001000000"), "585#6001160000000000");
  }
}

TEST(AxisNode, ActsAndAnswersOnSync) {
  Node node;
  map_pdos(node);
  EXPECT_EQ(node.answer("080#"), "") << "not before it is operational";
  (void)node.answer("000#0105");
  EXPECT_EQ(node.answer("205#060010270000"), "");
  EXPECT_EQ(node.answer("605#4041600000000000"), "585#4B41600050060000") << "not before the SYNC";
  EXPECT_EQ(node.answer("080#"), "185#31060000000000");
  EXPECT_EQ(node.answer("605#407A600000000000"), "585#437A600010270000");
  (void)node.answer("205#0700");
  EXPECT_EQ(node.answer("080#"), "085#1082000000000000 185#31060000000000") << "too short: emergency 8210";
}

TEST(AxisNode, StopsAndReportsALostMaster) {
  Node node;
  (void)node.said();
  (void)node.answer("605#2B07600003000000");
  (void)node.answer("605#2F29100101000000");
  (void)node.answer("605#231610012C017F00");
  EXPECT_EQ(node.run(1000), "") << "watched from the first heartbeat on";
  (void)node.answer("77F#05");
  EXPECT_EQ(node.run(300), "");
  EXPECT_EQ(node.run(1), "085#3081010000000000");
  EXPECT_EQ(node.answer("605#403F600000000000"), "585#4B3F600030810000");
  EXPECT_EQ(node.answer("77F#05"), "085#0000000000000000") << "and that it is back";
}

}  // namespace
}  // namespace luxrig::sim
