// `luxrig rdm` against the simulated node of a rig.
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/tools/programs/process.h"

namespace luxrig::testing {
namespace {

using nlohmann::json;

/// The heads of rigs/studio on an Art-Net node, or on the line of a USB widget.
class RdmCommand : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    const std::string driver = GetParam();
    std::string rig = text_of(source("rigs/studio/rig.toml"));
    const auto replace = [&](const std::string& what, const std::string& by) {
      for (auto at = rig.find(what); at != std::string::npos; at = rig.find(what, at + by.size()))
        rig.replace(at, what.size(), by);
    };
    replace("driver = \"artnet\"", "driver = \"" + driver + "\"");
    replace("file = \"", "file = \"" + source("rigs/studio") + "/");
    if (driver != "artnet") {
      replace("destination = ", "# ");
      replace("universe = 0", "universe = 1");
    }
    std::ofstream(folder_ / "rig.toml") << rig;
    sim_ = std::make_unique<Process>(
        std::vector<std::string>{program("luxrig-sim"), (folder_ / "rig.toml").string(), "--seed", "3", "--ports-file",
                                 (folder_ / "ports.json").string(), "--max-error", "0.1"},
        folder_ / "sim.log");
    ASSERT_TRUE(wait_for([&] { return sim_->output().find("ready") != std::string::npos; }, 60s)) << sim_->output();
    const json ports = json::parse(text_of(folder_ / "ports.json"));
    const std::string at = "127.0.0.1:" + std::to_string(ports["buses"]["stage"]["port"].get<int>());
    where_ = {driver == "artnet" ? "--node" : "--usbip", at};
  }
  [[nodiscard]] Ran rdm(std::vector<std::string> words) const {
    words.insert(words.begin(), {program("luxrig"), "rdm"});
    words.insert(words.end(), where_.begin(), where_.end());
    words.insert(words.end(), {"--seconds", "1"});
    return luxrig::testing::run(words);
  }

 private:
  Folder folder_;
  std::unique_ptr<Process> sim_;
  std::vector<std::string> where_;
};

TEST_P(RdmCommand, ListsThePatchedHeadsAndReaddressesOne) {
  const Ran listed = rdm({"list", "--json"});
  ASSERT_EQ(listed.code, 0) << listed.output;
  const json devices = json::parse(listed.output, nullptr, false);
  ASSERT_EQ(devices.size(), 3u) << listed.output;
  EXPECT_EQ(devices[1]["label"], "fill");
  EXPECT_EQ(devices[1]["address"], 11);
  EXPECT_EQ(devices[1]["slots"][5], "dimmer");
  const std::string uid = devices[1]["uid"];

  const Ran set = rdm({"set", uid, "address", "101"});
  ASSERT_EQ(set.code, 0) << set.output;
  const Ran got = rdm({"get", uid, "dmx_start_address"});
  ASSERT_EQ(got.code, 0) << got.output;
  EXPECT_NE(got.output.find("101"), std::string::npos) << got.output;

  const Ran stubs = rdm({"list", "--toml"});
  ASSERT_EQ(stubs.code, 0) << stubs.output;
  EXPECT_NE(stubs.output.find("address = 101"), std::string::npos) << stubs.output;
}

TEST_P(RdmCommand, ReportsErrors) {
  const Ran unknown = rdm({"get", "7ff0:00000009", "device_info"});
  EXPECT_EQ(unknown.code, 1);
  EXPECT_NE(unknown.output.find("is on no line"), std::string::npos) << unknown.output;
  const Ran parameter = rdm({"get", "7ff0:00000001", "no_such"});
  EXPECT_EQ(parameter.code, 2);
  EXPECT_NE(parameter.output.find("no_such is no parameter"), std::string::npos) << parameter.output;
  EXPECT_EQ(rdm({"get", "nonsense", "address"}).code, 2);
}

INSTANTIATE_TEST_SUITE_P(On, RdmCommand, ::testing::Values("artnet", "enttec_pro"),
                         [](const auto& driver) { return std::string(driver.param); });

TEST(RdmPlaces, AreRefusedIfInvalid) {
  const auto refused = [](std::vector<std::string> words) {
    words.insert(words.begin(), {program("luxrig"), "rdm", "list"});
    return luxrig::testing::run(words);
  };
  EXPECT_EQ(refused({"--usb", "--node", "127.0.0.1"}).code, 2);
  EXPECT_EQ(refused({"--usbip", "127.0.0.1"}).code, 2);
  EXPECT_EQ(refused({"--usb-port", "left"}).code, 2);
  EXPECT_EQ(refused({"--usbip", "127.0.0.1:9"}).code, 1) << "nobody there";
}

}  // namespace
}  // namespace luxrig::testing
