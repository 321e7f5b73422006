#include "tools/luxrig/rdm_stubs.h"

#include <gtest/gtest.h>

namespace luxrig {
namespace {

rdm::DeviceProfile head_profile() {
  rdm::DeviceProfile profile;
  profile.uid = {0x7a70, 2};
  profile.info.footprint_slots = 8;
  profile.info.start_address = 17;
  profile.info.personality = profile.info.personalities = 1;
  profile.manufacturer = "Maker";
  profile.model = "Spot";
  profile.label = "a \"head\"";
  profile.slots = {{0, 0, 0x0101}, {1, 1, 0}, {2, 0, 0x0102}, {3, 1, 2},
                   {4, 0, 0x0001}, {5, 1, 4}, {6, 1, 4},      {7, 0, 0x0205}};
  return profile;
}

TEST(RdmStubs, NameTheDescribedSlots) {
  EXPECT_EQ(slot_names(head_profile()), (std::vector<std::string>{"pan", "pan-fine", "tilt", "tilt-fine", "dimmer",
                                                                  "dimmer-fine", "dimmer-ultra", "unused"}));
  rdm::DeviceProfile odd = head_profile();
  odd.slots = {{200, 0, 0x0001}, {3, 1, 200}, {0, 1, 1}};  // beyond its footprint
  EXPECT_EQ(slot_names(odd), std::vector<std::string>(8, "unused"));
}

TEST(RdmStubs, AreValidRigFileFixtures) {
  rdm::DeviceProfile plain = head_profile();
  plain.slots.clear();
  rdm::DeviceProfile rack = head_profile();
  rack.info.start_address.reset();  // no slots, no fixture
  const std::string text = fixture_stubs({{3, head_profile()}, {4, plain}, {4, rack}});
  EXPECT_NE(text.find("[[fixture]]  # 7a70:00000002: Maker Spot, personality 1 of 1, 8 slots\n"
                      "name = \"a \\\"head\\\"\"\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("universe = 3\naddress = 17\nslots = [\"pan\", \"pan-fine\""), std::string::npos) << text;
  EXPECT_NE(text.find("name = \"a \\\"head\\\"-2\""), std::string::npos) << text;
  EXPECT_NE(text.find("# FILL IN: slots"), std::string::npos) << text;
  EXPECT_EQ(text.find("-3"), std::string::npos) << text;
}

}  // namespace
}  // namespace luxrig
