/// Discovery of random lines: every well-behaved device is found, whatever the others do, with a bounded number of
/// requests.
#include "drivers/dmx/rdm/rdm_discovery.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/random.h"

namespace luxrig::rdm {
namespace {

enum class Habit {
  good,
  silent,          ///< never answers discovery
  never_confirms,  ///< answers branches, but not its mute
  never_mutes,     ///< confirms its mute, but goes on answering
  everywhere,      ///< answers any branch until it is muted, which it confirms
  for_ever         ///< answers any branch, and confirms nothing
};

struct Device {
  Uid uid;
  Habit habit = Habit::good;
  bool muted = false;
};

/// How several simultaneous answers sound.
enum class Clash { bits_add_up, noise, strongest_wins };

class Line final : public DiscoveryLine {
 public:
  Line(std::vector<Device> devices, Clash clash, double loss, unsigned seed)
      : devices_(std::move(devices)), clash_(clash), loss_(loss), random_(seed) {}

  Result<void> un_mute_everybody() override {
    for (Device& device : devices_) device.muted = device.muted && lost();
    return {};
  }

  Result<std::vector<std::uint8_t>> ask_branch(const Uid& lowest, const Uid& highest) override {
    EXPECT_LE(lowest, highest);
    std::vector<std::vector<std::uint8_t>> answers;
    for (const Device& device : devices_) {
      const bool anywhere = device.habit == Habit::everywhere || device.habit == Habit::for_ever;
      const bool speaks = device.habit != Habit::silent && !device.muted &&
                          (anywhere || (device.uid >= lowest && device.uid <= highest));
      if (speaks && !lost()) answers.push_back(encode_branch_answer(device.uid));
    }
    if (answers.empty()) return std::vector<std::uint8_t>{};
    std::vector<std::uint8_t> heard = answers.front();
    if (answers.size() == 1 || clash_ == Clash::strongest_wins) return heard;
    for (std::size_t i = 1; i < answers.size(); ++i) {
      for (std::size_t b = 0; b < heard.size(); ++b) {
        heard[b] = clash_ == Clash::noise ? static_cast<std::uint8_t>(random_.below(256)) : heard[b] | answers[i][b];
      }
    }
    return heard;
  }

  Result<bool> mute(const Uid& who) override {
    bool confirmed = false;
    for (Device& device : devices_) {
      if (device.uid != who || lost()) continue;
      const bool confirms = device.habit != Habit::never_confirms && device.habit != Habit::for_ever;
      device.muted = confirms && device.habit != Habit::never_mutes;
      confirmed = confirms && !lost();
    }
    return confirmed;
  }

  [[nodiscard]] const std::vector<Device>& devices() const { return devices_; }

 private:
  bool lost() { return loss_ > 0 && random_.between(0, 1) < loss_; }

  std::vector<Device> devices_;
  Clash clash_;
  double loss_;
  Random random_;
};

/// Some from one batch, with neighbouring numbers; the rest random.
std::vector<Device> random_devices(std::size_t count, Random& random) {
  std::set<std::uint64_t> numbers;
  while (numbers.size() < count) {
    const std::uint64_t batch = random.below(3) == 0 ? random.below(0xFFFE) << 32 | random.below(0xFFFFFFFF)
                                                     : 0x7a7000000100 + random.below(2 * count);
    if (!is_broadcast(uid_of(batch))) numbers.insert(batch);
  }
  std::vector<Device> devices;
  for (const std::uint64_t number : numbers) devices.push_back({uid_of(number), Habit::good, random.below(2) == 0});
  return devices;
}

std::vector<Uid> with(const std::vector<Device>& devices, std::initializer_list<Habit> habits) {
  std::vector<Uid> uids;
  for (const Device& device : devices) {
    if (std::find(habits.begin(), habits.end(), device.habit) != habits.end()) uids.push_back(device.uid);
  }
  return uids;
}

TEST(RdmDiscovery, TakesFiveRequestsOnAnEmptyLine) {
  Line line({}, Clash::bits_add_up, 0, 1);
  const auto result = discover(line);
  ASSERT_TRUE(result);
  EXPECT_TRUE(result->found.empty() && result->unmutable.empty() && result->complete);
  EXPECT_EQ(result->requests, 3 + 2);
}

TEST(RdmDiscovery, FindsUpTo200DevicesUnderAnyCollisions) {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    Random random(seed);
    const std::size_t count = seed == 1 ? 200 : 1 + random.below(200);
    const auto clash = static_cast<Clash>(seed % 3);
    Line line(random_devices(count, random), clash, 0, seed);
    const auto result = discover(line);
    ASSERT_TRUE(result);
    EXPECT_EQ(result->found, with(line.devices(), {Habit::good})) << "seed " << seed;
    EXPECT_TRUE(result->unmutable.empty()) << "seed " << seed;
    EXPECT_TRUE(result->complete);
    // Each device costs one mute and at most one descent of the tree, with four mute attempts where colliding answers
    // decode to a valid one.
    EXPECT_LE(result->requests, 20 + 48 * static_cast<int>(count)) << "seed " << seed;
  }
}

TEST(RdmDiscovery, FindsWellBehavedDevicesAmongFaultyOnes) {
  int max_requests = 0;
  for (unsigned seed = 1; seed <= 90; ++seed) {
    Random random(seed);
    const auto clash = static_cast<Clash>(seed % 3);
    auto devices = random_devices(10 + random.below(150), random);
    for (int i = 0; i < 4; ++i) {
      devices[random.below(devices.size())].habit = Habit::silent;
      devices[random.below(devices.size())].habit = Habit::never_mutes;
      devices[random.below(devices.size())].habit = Habit::never_confirms;
    }
    for (Device& device : devices) device.muted = device.muted && device.habit == Habit::good;
    Line line(std::move(devices), clash, 0, seed);
    const auto result = discover(line);
    ASSERT_TRUE(result);
    max_requests = std::max(max_requests, result->requests);
    EXPECT_TRUE(result->complete) << "seed " << seed;
    EXPECT_EQ(result->found, with(line.devices(), {Habit::good, Habit::never_mutes})) << "seed " << seed;
    EXPECT_EQ(result->unmutable, with(line.devices(), {Habit::never_mutes, Habit::never_confirms})) << "seed " << seed;
  }
  EXPECT_LE(max_requests, 20000);
  RecordProperty("most_requests", max_requests);
}

/// True if an answer adds no bit to another's, so that its sender cannot be heard beside the other.
bool drowned_by(const Uid& who, const Uid& by) {
  const auto answer = encode_branch_answer(who), other = encode_branch_answer(by);
  for (std::size_t i = 0; i < answer.size(); ++i) {
    if ((answer[i] | other[i]) != other[i]) return false;
  }
  return true;
}

TEST(RdmDiscovery, EndsDespiteDevicesThatAnswerForForeignRanges) {
  std::size_t drowned = 0;
  for (unsigned seed = 1; seed <= 30; ++seed) {
    Random random(seed);
    auto devices = random_devices(2 + random.below(40), random);
    devices[random.below(devices.size())].habit = seed % 2 == 0 ? Habit::everywhere : Habit::for_ever;
    for (Device& device : devices) device.muted = device.muted && device.habit == Habit::good;
    Line line(std::move(devices), Clash::bits_add_up, 0, seed);
    const auto result = discover(line);
    ASSERT_TRUE(result);
    EXPECT_TRUE(result->complete) << "seed " << seed;
    auto wanted = with(line.devices(), {Habit::good, Habit::everywhere});
    for (const Uid& loud : with(line.devices(), {Habit::for_ever})) {
      std::erase_if(wanted, [&](const Uid& uid) { return drowned_by(uid, loud); });
    }
    for (const Uid& uid : wanted) {
      EXPECT_TRUE(std::binary_search(result->found.begin(), result->found.end(), uid)) << seed << " " << text_of(uid);
    }
    const auto all = with(line.devices(), {Habit::good, Habit::everywhere});
    EXPECT_TRUE(std::includes(all.begin(), all.end(), result->found.begin(), result->found.end()));
    drowned += all.size() - wanted.size();
    EXPECT_LE(result->requests, 20000) << "seed " << seed;
  }
  EXPECT_LE(drowned, 2u);  // of about six hundred
}

TEST(RdmDiscovery, FindsDevicesWithATenthOfPacketsLost) {
  std::size_t missed = 0, all = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    Random random(seed);
    Line line(random_devices(1 + random.below(60), random), Clash::bits_add_up, 0.1, seed);
    const auto result = discover(line);
    ASSERT_TRUE(result);
    EXPECT_TRUE(result->complete);
    const auto wanted = with(line.devices(), {Habit::good});
    EXPECT_TRUE(std::includes(wanted.begin(), wanted.end(), result->found.begin(), result->found.end()));
    missed += wanted.size() - result->found.size();
    all += wanted.size();
  }
  EXPECT_LE(missed * 200, all);  // one in two hundred
}

TEST(RdmDiscovery, EndsOnALineOfPureNoise) {
  class Noise final : public DiscoveryLine {
   public:
    Result<void> un_mute_everybody() override { return {}; }
    Result<std::vector<std::uint8_t>> ask_branch(const Uid&, const Uid&) override {
      return std::vector<std::uint8_t>{1, 2, 3};
    }
    Result<bool> mute(const Uid&) override { return false; }
  };
  Noise line;
  DiscoveryLimits limits;
  limits.requests = 3000;
  const auto result = discover(line, limits);
  ASSERT_TRUE(result);
  EXPECT_FALSE(result->complete);
  EXPECT_TRUE(result->found.empty());
  EXPECT_LE(result->requests, 3000);
}

}  // namespace
}  // namespace luxrig::rdm
