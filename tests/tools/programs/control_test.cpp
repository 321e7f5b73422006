// Features for real devices, over the wire: parking, keep-out zones, and outputs without data.
#include <gtest/gtest.h>

#include <map>

#include "tests/tools/programs/live_rig.h"

namespace luxrig::testing {
namespace {

std::map<std::string, double> levels_of(const json& truth) {
  std::map<std::string, double> level;
  for (const json& f : truth.at("fixtures")) level[f["name"]] = f["level"].get<double>();
  return level;
}

TEST(Control, OutputsBehaveWithoutDataAsCheckStates) {
  const std::string rig_file = source("tests/rigs/without-data");
  const Ran table = luxrig::testing::run({program("luxrig"), "check", rig_file, "--outputs"});
  ASSERT_EQ(table.code, 0) << table.output;
  for (const char* text :
       {"noticed after 2.5 s; then its maker's choice", "goes dark after 2 s",
        "WAGO 750 coupler with 750-559, its watchdog, which Luxrig arms", "holds its last level", "nobody says",
        "(sacn): nothing comes back; a dead node or lamp is noticed only by a luxmeter or camera",
        "Modbus does not: give its product's register_map"})
    EXPECT_NE(table.output.find(text), std::string::npos) << text << "\n" << table.output;
  const Ran checked = luxrig::testing::run({program("luxrig"), "check", rig_file, "--outputs", "--json"});
  const json outputs = json::parse(checked.output, nullptr, false)["outputs"];
  ASSERT_EQ(outputs.size(), 5u) << checked.output;

  LiveRig rig(rig_file, {"--no-guardian"});
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.daemon().output();
  std::this_thread::sleep_for(1s);
  const auto lit = levels_of(rig.truth());
  for (const auto& [name, level] : lit) ASSERT_GT(level, 0.01) << name;
  rig.daemon().signal(SIGKILL);
  const auto killed = std::chrono::steady_clock::now();
  const auto passed_s = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - killed).count();
  };
  // The last data came within refresh_ms = 400 before the end; then a lamp dims with its own decay.
  const auto may_dim_after_s = [&](const std::string& name) {
    for (const json& output : outputs)
      if (output["fixture"] == name && output["without_data"] == "goes_dark")
        return output["after_s"].get<double>() - 0.6;
    return 1e9;
  };
  // Art-Net drops a source after 10 s; watch longer than that.
  std::map<std::string, double> dark_after_s;
  while (passed_s() < 13) {
    const double at_s = passed_s();
    for (const auto& [name, level] : levels_of(rig.truth())) {
      if (level < 0.001) {
        dark_after_s.emplace(name, at_s);
      } else {
        EXPECT_FALSE(dark_after_s.contains(name)) << name << " is lit again";
        if (at_s >= may_dim_after_s(name)) continue;
        EXPECT_NEAR(level, lit.at(name), 0.02 * lit.at(name)) << name << " after " << at_s << " s";
      }
    }
    std::this_thread::sleep_for(50ms);
  }
  for (const json& output : outputs) {
    const std::string name = output["fixture"];
    if (output["without_data"] == "goes_dark") {
      ASSERT_TRUE(dark_after_s.contains(name)) << name;
      EXPECT_GT(dark_after_s[name], may_dim_after_s(name));
      EXPECT_LT(dark_after_s[name], output["after_s"].get<double>() + 1);
    } else {
      // If the behaviour is the maker's choice, simulated fixtures and registers hold.
      EXPECT_FALSE(dark_after_s.contains(name)) << name << " after " << dark_after_s[name] << " s";
    }
  }
}

TEST(Control, AParkedHeadRestsUntilTheNextPlanEvenAcrossARestart) {
  LiveRig rig(source("tests/rigs/parking"));
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.daemon().output();
  const auto park = [&](const std::vector<std::string>& names) {
    std::vector<std::string> words = {program("luxrig"), "park", "--port", std::to_string(rig.port())};
    words.insert(words.end(), names.begin(), names.end());
    return luxrig::testing::run(words);
  };
  const Ran unknown = park({"haed"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_NE(unknown.output.find("did you mean \"head\"?"), std::string::npos) << unknown.output;
  const Ran fixed = park({"bulb"});
  EXPECT_EQ(fixed.code, 2);
  EXPECT_NE(fixed.output.find("bulb has no place to rest"), std::string::npos) << fixed.output;
  const auto rests = [&] {
    const json truth = rig.truth();
    for (const json& f : truth.at("fixtures"))
      if (f["name"] == "head") return f["level"].get<double>() == 0 && std::abs(f["tilt_deg"].get<double>() - 100) < 5;
    return false;
  };
  EXPECT_FALSE(rests());
  EXPECT_EQ(park({}).code, 0);
  EXPECT_TRUE(wait_for(rests, 10s)) << rig.truth();
  EXPECT_GT(levels_of(rig.truth())["bulb"], 0.01);
  ASSERT_TRUE(rig.wait_status([](const json& s) { return s["fixtures"][0].value("parked", false); }, 2s)) << rig.last();
  // An acknowledged park is remembered.
  rig.daemon().signal(SIGKILL);
  rig.start_daemon();
  ASSERT_TRUE(rig.wait_status([](const json& s) { return s["fixtures"][0].value("parked", false); }, 60s))
      << rig.last();
  for (int i = 0; i < 40; ++i) {
    EXPECT_EQ(levels_of(rig.truth())["head"], 0);
    std::this_thread::sleep_for(100ms);
  }
  // It also parks at its end, and the other lamps go to the safe look.
  rig.daemon().signal(SIGTERM);
  EXPECT_TRUE(wait_for([&] { return rig.daemon().output().find("ended in the safe look") != std::string::npos; }, 20s))
      << rig.daemon().output();
  EXPECT_NE(rig.daemon().output().find("heads go dark and to where they rest"), std::string::npos);
  EXPECT_TRUE(rests());
  EXPECT_GT(levels_of(rig.truth())["bulb"], 0.01);
}

TEST(Control, APlanThatLightsAKeepOutZoneIsRefused) {
  const Folder folder;
  const std::string rig = source("tests/rigs/parking");
  const auto plan_file = folder / "plan.json";
  const Ran solved =
      luxrig::testing::run({program("luxrig"), "solve", rig, "-o", plan_file.string(), "--max-error", "0.05"});
  ASSERT_EQ(solved.code, 0) << solved.output;
  json plan = json::parse(text_of(plan_file));
  for (json& light : plan["tasks"][0]["lights"]) {
    if (light["name"] != "head") continue;
    light["pan_deg"] = -90;
    light["tilt_deg"] = 60;
    light["level"] = 0.5;
  }
  std::ofstream(plan_file) << plan.dump();
  const Ran refused = luxrig::testing::run(
      {program("luxrig"), "run", rig, "--sim", "--once", "--plan", plan_file.string(), "--port", "0"});
  EXPECT_EQ(refused.code, 2) << refused.output;
  EXPECT_NE(refused.output.find("fixture \"head\" would light keep-out zone \"audience\""), std::string::npos)
      << refused.output;
  const Ran checked = luxrig::testing::run({program("luxrig"), "check", rig});
  EXPECT_EQ(checked.code, 0) << checked.output;
  EXPECT_EQ(checked.output.find("looks into"), std::string::npos);
}

}  // namespace
}  // namespace luxrig::testing
