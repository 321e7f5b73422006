// A client that follows the changes knows what the whole status says, and gets no more than what changed.
#include "tools/luxrigd/api/status_changes.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace luxrig {
namespace {

using nlohmann::json;

struct Running {
  Rig rig;
  ShowStatus show;
  std::vector<Health> devices;
  Time now = Time{} + std::chrono::seconds(10);
  std::shared_ptr<const int> owner = std::make_shared<int>(1);
  StatusChanges changes;

  Running() {
    rig.name = "hall";
    rig.buses.resize(1);
    rig.buses[0].name = "dmx";
    rig.luminaires.resize(1);
    rig.fixtures.resize(2);
    rig.points.resize(100);
    show.fixtures.resize(2);
    show.points.resize(100);
    for (std::size_t p = 0; p < 100; ++p) rig.points[p].name = "p" + std::to_string(p);
    devices.resize(1);
    devices[0].device = "dmx";
  }
  json since(const std::string& version) {
    const StatusInput input{rig, show, devices, {}, true, Time{}, now};
    return json::parse(changes.since(version, input, owner, "etag"));
  }
  json later(const std::string& version) {
    now += std::chrono::milliseconds(100);
    return since(version);
  }
};

TEST(StatusChanges, APointCostsBytesOnlyWhenItChanges) {
  Running r;
  const json whole = r.since("");
  EXPECT_TRUE(whole["whole"]);
  EXPECT_EQ(whole["points"].size(), 100u);
  EXPECT_EQ(whole["changed"]["rig"], "hall");
  EXPECT_EQ(whole["rig_etag"], "etag");
  json next = r.later(whole["version"]);
  EXPECT_FALSE(next["whole"]);
  EXPECT_EQ(next["changed"].dump(), "{}");
  EXPECT_EQ(next["version"], whole["version"]);
  EXPECT_FALSE(next.contains("points"));
  EXPECT_LT(next.dump().size(), 200u);

  r.show.points[7].measured_lx = 55;
  r.show.points[7].measured_at = r.now;
  r.show.phase = Phase::measuring;
  const json changed = r.later(next["version"]);
  ASSERT_EQ(changed["points"].size(), 1u);
  EXPECT_EQ(changed["points"][0]["index"], 7);
  EXPECT_EQ(changed["points"][0]["measured_lux"], 55);
  EXPECT_NEAR(changed["points"][0]["measured_at_s"], 10.1, 1e-9);
  EXPECT_EQ(changed["changed"].dump(), R"({"phase":"measuring"})");
  EXPECT_FALSE(changed.contains("fixtures"));
  EXPECT_FALSE(r.later(changed["version"]).contains("points")) << "its age is no change";
  EXPECT_EQ(r.later(whole["version"])["points"].size(), 1u) << "a slower client";
}

TEST(StatusChanges, WhatIsGoneIsNull) {
  Running r;
  const json without = r.since("");
  r.show.may_be_measured = true;
  const json with = r.later(without["version"]);
  EXPECT_EQ(with["changed"].dump(), R"({"may_be_measured":true})");
  r.show.may_be_measured = false;
  EXPECT_EQ(r.later(with["version"])["changed"].dump(), R"({"may_be_measured":null})");
}

TEST(StatusChanges, AnUnknownVersionGetsAllOfIt) {
  Running r;
  const std::string version = r.since("")["version"];
  const std::string before = version.substr(0, version.rfind('-') + 1);
  for (const std::string& unknown : {std::string(), std::string("x"), before, before + "-1", before + "1x",
                                     before + "99999999", before + "99999999999999999999999", version + "0"})
    EXPECT_TRUE(r.since(unknown)["whole"]) << unknown;
  EXPECT_FALSE(r.since(version)["whole"]);
  Running other_daemon;
  EXPECT_TRUE(other_daemon.since(version)["whole"]);
  // Another rig: fewer points, and every index means another thing.
  r.rig.points.resize(3);
  r.show.points.resize(3);
  r.owner = std::make_shared<int>(2);
  const json reloaded = r.later(version);
  EXPECT_TRUE(reloaded["whole"]);
  EXPECT_EQ(reloaded["points"].size(), 3u);
  r.devices.clear();
  EXPECT_TRUE(r.later(reloaded["version"])["whole"]) << "a device that is gone";
}

TEST(StatusChanges, AnOlderStatusChangesNothing) {
  Running r;
  const json first = r.since("");
  r.show.points[1].measured_lx = 5;
  const json second = r.later(first["version"]);
  r.now -= std::chrono::milliseconds(50);
  r.show.points[1].measured_lx = 4;
  EXPECT_EQ(r.since(second["version"])["version"], second["version"]);
}

}  // namespace
}  // namespace luxrig
