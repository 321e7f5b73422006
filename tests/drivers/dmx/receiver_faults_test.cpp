/// Receivers while the network loses, doubles, reorders and damages packets, from a seed: they never show a value that
/// was not sent, never an older one after a newer, and report loss in the protocol's time.
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <random>

#include "drivers/dmx/artnet/artnet_receiver.h"
#include "drivers/dmx/sacn/sacn_receiver.h"
#include "tests/drivers/test_rig.h"

namespace luxrig {
namespace {

using Packet = std::vector<std::uint8_t>;

/// Packets in, packets out: none, one or two, or delayed behind later ones.
class FaultyNetwork {
 public:
  /// fixed: bytes whose change a receiver can detect. (UDP's checksum detects a change of a level.)
  FaultyNetwork(unsigned seed, std::vector<std::size_t> fixed) : random_(seed), fixed_(std::move(fixed)) {}

  std::vector<Packet> through(Packet packet) {
    std::vector<Packet> out;
    const auto fate = random_() % 100;
    if (fate < 10) {
      // lost
    } else if (fate < 20) {
      out = {packet, packet};
    } else if (fate < 30) {
      late_.emplace_back(1 + random_() % 3, packet);
    } else if (fate < 35) {
      packet[fixed_[random_() % fixed_.size()]] ^= static_cast<std::uint8_t>(1 + random_() % 255);
      out = {packet};
    } else if (fate < 40) {
      packet.resize(random_() % packet.size());
      out = {packet};
    } else {
      out = {packet};
    }
    for (auto& [wait, held] : late_) {
      if (--wait == 0) out.push_back(held);
    }
    std::erase_if(late_, [](const auto& entry) { return entry.first == 0; });
    return out;
  }

 private:
  std::mt19937 random_;
  std::vector<std::size_t> fixed_;
  std::vector<std::pair<unsigned, Packet>> late_;
};

std::vector<std::size_t> positions_in(std::initializer_list<std::pair<std::size_t, std::size_t>> ranges) {
  std::vector<std::size_t> all;
  for (const auto& [from, to] : ranges) {
    for (std::size_t at = from; at < to; ++at) all.push_back(at);
  }
  return all;
}

constexpr int kFrames = 3000;
constexpr double kFrame_ms = 25;

/// All slots of frame k have the value k % 251, so that a mixture of two frames shows.
std::vector<std::uint8_t> frame_slots(int k) {
  return std::vector<std::uint8_t>(512, static_cast<std::uint8_t>(k % 251));
}

/// Age of the look in frames; fails if it matches no frame.
int age_of(const HeardUniverse& heard, int k) {
  EXPECT_TRUE(std::all_of(heard.levels.slots.begin(), heard.levels.slots.end(),
                          [&](std::uint8_t slot) { return slot == heard.levels.slots[0]; }));
  EXPECT_LT(heard.levels.slots[0], 251);
  return (k % 251 - heard.levels.slots[0] + 251) % 251;
}

template <class Hear>
void watch(unsigned seed, const Hear& look_after_frame) {
  int newest = -1;
  for (int k = 0; k < kFrames; ++k) {
    const std::optional<int> age = look_after_frame(k);
    if (!age) continue;
    ASSERT_LE(*age, 30) << "seed " << seed << " frame " << k;  // a gap of that many frames has no chance here
    ASSERT_GE(k - *age, newest) << "seed " << seed << " frame " << k;
    newest = k - *age;
  }
  EXPECT_GT(newest, kFrames - 30);
}

TEST(ReceiverFaults, SacnShowsOnlySentFramesInOrderAndLosesTheDeskInTime) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    FaultyNetwork network(seed, positions_in({{0, 22}, {38, 44}, {115, 125}}));
    sacn::ReceiverSettings settings;
    settings.universes = {1};
    sacn::Receiver receiver(settings);
    double heard_ms = 0;
    watch(seed, [&](int k) -> std::optional<int> {
      sacn::DataPacket packet;
      packet.sequence = static_cast<std::uint8_t>(k);
      packet.slots = frame_slots(k);
      for (const Packet& bytes : network.through(encode(packet))) {
        if (receiver.receive(at_ms(k * kFrame_ms), bytes) == sacn::Receiver::Verdict::taken) heard_ms = k * kFrame_ms;
      }
      const HeardUniverse heard = receiver.heard(at_ms(k * kFrame_ms), 1);
      if (heard.presence != DeskPresence::present) {
        EXPECT_LT(k * kFrame_ms, 3100);  // sampling, and the new source's wait
        return std::nullopt;
      }
      return age_of(heard, k);
    });
    EXPECT_EQ(receiver.heard(at_ms(heard_ms + 2500), 1).presence, DeskPresence::present) << seed;
    EXPECT_EQ(receiver.heard(at_ms(heard_ms + 2501), 1).presence, DeskPresence::absent) << seed;
  }
}

TEST(ReceiverFaults, ArtnetShowsOnlySentFramesInOrderAndLosesTheDeskInTime) {
  const SocketAddress desk{0x0A000001, artnet::kPort};
  for (unsigned seed = 1; seed <= 20; ++seed) {
    // Not the operation code (bytes 8, 9) and the length (16, 17): another one can make a valid packet. UDP's checksum
    // guards them.
    FaultyNetwork network(seed, positions_in({{0, 8}, {10, 11}}));
    artnet::ReceiverSettings settings;
    settings.port_addresses = {1};
    artnet::Receiver receiver(settings);
    double heard_ms = 0;
    watch(seed, [&](int k) -> std::optional<int> {
      const artnet::Dmx packet{static_cast<std::uint8_t>(k % 255 + 1), 0, 1, frame_slots(k)};
      for (const Packet& bytes : network.through(artnet::encode(packet))) {
        if (receiver.receive(at_ms(k * kFrame_ms), desk, bytes) == artnet::Receiver::Verdict::taken) {
          heard_ms = k * kFrame_ms;
        }
      }
      const HeardUniverse heard = receiver.heard(at_ms(k * kFrame_ms), 1);
      if (heard.presence != DeskPresence::present) return std::nullopt;
      return age_of(heard, k);
    });
    EXPECT_EQ(receiver.heard(at_ms(heard_ms + 10000), 1).presence, DeskPresence::present) << seed;
    EXPECT_EQ(receiver.heard(at_ms(heard_ms + 10001), 1).presence, DeskPresence::absent) << seed;
  }
}

TEST(ReceiverFaults, TwoMergedSacnDesksShowTheBrighterOfSentFrames) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const std::vector<std::size_t> fixed = positions_in({{0, 22}, {38, 44}, {115, 125}});
    FaultyNetwork networks[] = {{seed, fixed}, {seed + 1000, fixed}};
    sacn::ReceiverSettings settings;
    settings.universes = {1};
    sacn::Receiver receiver(settings);
    std::deque<int> recent[2];
    for (int k = 0; k < 1000; ++k) {
      for (int desk = 0; desk < 2; ++desk) {
        sacn::DataPacket packet;
        packet.cid[0] = static_cast<std::uint8_t>(desk + 1);
        packet.sequence = static_cast<std::uint8_t>(k);
        const int value = (k * (desk == 0 ? 1 : 7)) % 256;
        packet.slots.assign(512, static_cast<std::uint8_t>(value));
        recent[desk].push_back(value);
        if (recent[desk].size() > 30) recent[desk].pop_front();
        for (const Packet& bytes : networks[desk].through(encode(packet))) {
          receiver.receive(at_ms(k * kFrame_ms), bytes);
        }
      }
      const HeardUniverse heard = receiver.heard(at_ms(k * kFrame_ms), 1);
      if (heard.presence != DeskPresence::present || k * kFrame_ms < 4000) continue;
      const int shown = heard.levels.slots[0];
      bool possible = false;
      for (const int a : recent[0]) {
        for (const int b : recent[1]) possible = possible || shown == std::max(a, b);
      }
      ASSERT_TRUE(possible) << "seed " << seed << " frame " << k << " shows " << shown;
    }
  }
}

}  // namespace
}  // namespace luxrig
