/// RDM through an ENTTEC DMX USB Pro: the client's own search and questions against the simulated widget and
/// responders.
#include <gtest/gtest.h>

#include <set>

#include "drivers/dmx/enttec_pro/widget_rdm.h"
#include "drivers/dmx/rdm/rdm_profile.h"
#include "sim/devices/rdm_line.h"
#include "sim/devices/usb/enttec_widget.h"
#include "tests/conformance/model_channel.h"
#include "tests/random.h"

namespace luxrig {
namespace {

using UsbBytes = std::vector<std::uint8_t>;

/// A widget with responders on its line, and a channel to it.
struct WidgetBench {
  sim::Faults faults{1};
  sim::RdmLine line{faults};
  sim::EnttecWidget widget;
  sim::FtdiChip chip{widget, "DMX USB PRO", "EN012345", false};
  ModelCable cable{chip};

  WidgetBench() {
    widget.connect([this](Time now, std::span<const std::uint8_t> packet) { return line.exchange(now, packet).bytes; });
  }
  std::set<rdm::Uid> add(std::size_t count) {
    Random random(7);
    std::set<rdm::Uid> uids;
    while (uids.size() < count) {
      const rdm::Uid uid{0x7ff0, static_cast<std::uint32_t>(random.below(300))};
      if (!uids.insert(uid).second) continue;
      sim::RdmIdentity identity;
      identity.uid = rdm::number_of(uid);
      identity.label = "lamp";
      identity.slots = {{0, 0x0001}};
      line.add(rdm::text_of(uid), identity);
    }
    return uids;
  }
  std::unique_ptr<enttec::WidgetRdm> open() {
    auto link = std::make_unique<enttec::WidgetRdm>(std::make_unique<ModelChannel>(cable), rdm::Uid{0x7ff0, 0xabcd});
    const auto opened = link->open();
    EXPECT_TRUE(opened) << opened.error().detail;
    return link;
  }
  Result<UsbBytes> ask(enttec::WidgetRdm& link, const rdm::Request& request) {
    rdm::Client client(link, {0x7ff0, 0xabcd});
    client.begin(request);
    for (;;) {
      client.step(cable.now);
      if (auto answer = client.take()) return *answer;
      cable.now += std::chrono::milliseconds(1);
    }
  }
};

std::set<rdm::Uid> set_of(const std::vector<rdm::Uid>& uids) { return {uids.begin(), uids.end()}; }

TEST(RdmOverUsb, FindsAllRespondersThatAnswerAtOnce) {
  WidgetBench bench;
  const std::set<rdm::Uid> wanted = bench.add(40);
  const auto link = bench.open();
  EXPECT_FALSE(link->may_lack_rdm());
  const auto found = rdm::discover(*link);
  ASSERT_TRUE(found) << found.error().detail;
  EXPECT_EQ(set_of(found->found), wanted);
  EXPECT_TRUE(found->complete);
  EXPECT_TRUE(found->unmutable.empty());
}

TEST(RdmOverUsb, ReadsAProfileAndSetsAStartAddress) {
  WidgetBench bench;
  const rdm::Uid uid = *bench.add(3).begin();
  const auto link = bench.open();
  const auto profile = rdm::read_profile([&](const rdm::Request& request) { return bench.ask(*link, request); }, uid);
  ASSERT_TRUE(profile) << profile.error().detail;
  EXPECT_EQ(profile->label, "lamp");
  EXPECT_EQ(profile->info.start_address, 1);
  ASSERT_TRUE(
      bench.ask(*link, {uid, rdm::CommandClass::set, rdm::Pid::dmx_start_address, rdm::encode_start_address(77)}));
  const auto address = bench.ask(*link, {uid, rdm::CommandClass::get, rdm::Pid::dmx_start_address});
  ASSERT_TRUE(address);
  EXPECT_EQ(rdm::decode_start_address(*address), std::optional<int>(77));
}

TEST(RdmOverUsb, SurvivesGarbledAnswersAndSilence) {
  WidgetBench bench;
  const std::set<rdm::Uid> uids = bench.add(4);
  const auto link = bench.open();
  const rdm::Uid uid = *uids.begin();
  const rdm::Request label{uid, rdm::CommandClass::get, rdm::Pid::device_label};
  bench.faults.set(rdm::text_of(uid), sim::FaultKind::lost, true, 0.3);
  int answered = 0;
  for (int i = 0; i < 20; ++i) answered += bench.ask(*link, label) ? 1 : 0;
  EXPECT_GE(answered, 16) << "three questions each";
  bench.faults.clear();
  bench.faults.set(rdm::text_of(uid), sim::FaultKind::garbled, true);
  const auto spoiled = bench.ask(*link, label);
  ASSERT_FALSE(spoiled);
  EXPECT_EQ(spoiled.error().cause, Cause::timeout);
  bench.faults.clear();
  EXPECT_TRUE(bench.ask(*link, label));
  bench.faults.set(rdm::text_of(uid), sim::FaultKind::silent, true);
  const auto silent = bench.ask(*link, label);
  ASSERT_FALSE(silent);
  EXPECT_EQ(silent.error().cause, Cause::timeout);
  const auto found = rdm::discover(*link);
  ASSERT_TRUE(found);
  std::set<rdm::Uid> others = uids;
  others.erase(uid);
  EXPECT_EQ(set_of(found->found), others);
}

TEST(RdmOverUsb, ReportsAnUnpluggedOrSilentWidget) {
  WidgetBench bench;
  bench.add(2);
  const auto link = bench.open();
  bench.cable.plugged_in = false;
  const auto found = rdm::discover(*link);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().cause, Cause::network);

  WidgetBench deaf;
  deaf.widget.set_character({.silent = true});
  enttec::WidgetRdm none(std::make_unique<ModelChannel>(deaf.cable), {0x7ff0, 0xabcd});
  const auto opened = none.open();
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().cause, Cause::timeout);
  EXPECT_NE(opened.error().detail.find("ENTTEC DMX USB Pro"), std::string::npos);
}

TEST(RdmOverUsb, FirmwareWithoutRdmFindsNoDeviceAndIsFlagged) {
  WidgetBench bench;
  bench.widget.connect({});
  const auto link = bench.open();
  EXPECT_TRUE(link->may_lack_rdm());
  const auto found = rdm::discover(*link);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->found.empty());
}

}  // namespace
}  // namespace luxrig
