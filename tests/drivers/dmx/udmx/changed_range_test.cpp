#include "drivers/dmx/udmx/changed_range.h"

#include <gtest/gtest.h>

namespace luxrig::udmx {
namespace {

TEST(ChangedRange, SpansFromTheFirstToTheLastChange) {
  DmxSlots known{}, wanted{};
  EXPECT_FALSE(changed_range(known, wanted));
  wanted[7] = 1;
  EXPECT_EQ(changed_range(known, wanted), (SlotRange{7, 1}));
  wanted[9] = 1;
  EXPECT_EQ(changed_range(known, wanted), (SlotRange{7, 3}));
  wanted[0] = wanted[511] = 1;
  EXPECT_EQ(changed_range(known, wanted), (SlotRange{0, 512}));
}

TEST(ChangedRange, OfA16BitValueHoldsBothBytesWhenBothChange) {
  DmxSlots known{}, wanted{};
  known[4] = 0x12, known[5] = 0xff;
  wanted[4] = 0x13, wanted[5] = 0x00;
  EXPECT_EQ(changed_range(known, wanted), (SlotRange{4, 2}));
}

}  // namespace
}  // namespace luxrig::udmx
