#include "drivers/modbus/modbus_contact.h"

#include <gtest/gtest.h>

namespace luxrig::modbus {
namespace {

using namespace std::chrono_literals;
constexpr Time kStart = Time{} + std::chrono::hours(1);

TEST(ModbusContact, IsUnknownBeforeItsFirstAnswerAndAfterASecondOfSilence) {
  ContactWatch contact({9, 4, true});
  EXPECT_EQ(contact.contact(kStart), Contact::unknown);
  const auto request = contact.due(kStart);
  ASSERT_TRUE(request);
  EXPECT_EQ(request->unit, 9);
  EXPECT_EQ(request->function, Function::read_discrete);
  EXPECT_EQ(request->first_register, 4);
  EXPECT_EQ(request->count, 1u);
  contact.asked(kStart);
  EXPECT_FALSE(contact.due(kStart + 50ms));
  EXPECT_TRUE(contact.due(kStart + 100ms)) << "in every call that writes levels";
  contact.answered(kStart, true);
  EXPECT_EQ(contact.contact(kStart + 900ms), Contact::rests);
  EXPECT_EQ(contact.contact(kStart + 1100ms), Contact::unknown);
}

TEST(ModbusContact, RequestsABlackoutInTheConfiguredState) {
  for (const bool when_open : {true, false}) {
    ContactWatch contact({1, 0, when_open});
    contact.answered(kStart, false);
    EXPECT_EQ(contact.contact(kStart), when_open ? Contact::pressed : Contact::rests);
    contact.answered(kStart, true);
    EXPECT_EQ(contact.contact(kStart), when_open ? Contact::rests : Contact::pressed);
  }
}

TEST(ModbusContact, OptionsAreChecked) {
  constexpr OptionDoc docs[] = {kContactInputOption, kContactUnitOption, kContactWhenOption};
  Rig rig;
  Bus bus;
  EXPECT_FALSE(contact_patch(bus, docs));
  bus.options["blackout_unit"] = {std::int64_t{3}, {}};
  auto problems = check_contact(rig, bus, docs, 1, 247);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_NE(problems[0].text().find("without blackout_input"), std::string::npos);
  bus.options["blackout_input"] = {std::int64_t{0}, {}};
  EXPECT_TRUE(check_contact(rig, bus, docs, 1, 247).empty());
  bus.options["blackout_when"] = {std::string("shut"), {}};
  bus.options["blackout_unit"] = {std::int64_t{0}, {}};
  EXPECT_EQ(check_contact(rig, bus, docs, 1, 247).size(), 2u);
  bus.options["blackout_when"] = {std::string("closed"), {}};
  const auto patch = contact_patch(bus, docs);
  ASSERT_TRUE(patch);
  EXPECT_FALSE(patch->when_open);
}

}  // namespace
}  // namespace luxrig::modbus
