/// The simulated sACN gateway: input = packets, each with the delay since the last. It shows levels only for universes
/// that exist, forgets silent sources, and keeps a bounded number of sources.
#include <algorithm>
#include <cstdlib>
#include <vector>

#include "sim/wire/sacn/sacn_receiver.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace luxrig;
  using namespace luxrig::sim;
  SacnReceiver receiver;
  Time now{};
  std::span<const std::uint8_t> rest(data, size);
  // Record: delay in units of 10 ms, length of the packet (two bytes), packet.
  while (rest.size() >= 3) {
    now += std::chrono::milliseconds(10 * rest[0]);
    const std::size_t length = std::min<std::size_t>(rest[1] << 8 | rest[2], rest.size() - 3);
    // On the heap, so that a read past its end is found.
    const std::vector<std::uint8_t> packet(rest.begin() + 3, rest.begin() + 3 + static_cast<std::ptrdiff_t>(length));
    rest = rest.subspan(3 + length);
    const auto verdict = receiver.receive(now, packet);
    const auto decoded = decode_sacn_data(packet);
    if (!decoded) {
      if (decode_sacn_sync(packet)
              ? verdict != SacnReceiver::Verdict::accepted && verdict != SacnReceiver::Verdict::ignored
              : verdict != SacnReceiver::Verdict::not_sacn) {
        std::abort();
      }
      continue;
    }
    const int universe = decoded->universe;
    if (universe < 1 || universe > 63999 || decoded->priority > 200 || decoded->slots.size() > kDmxSlots) std::abort();
    if (decoded->preview && verdict != SacnReceiver::Verdict::preview) std::abort();
    if (receiver.sources(universe, now) > 16) std::abort();
    if (verdict == SacnReceiver::Verdict::accepted) {
      if (receiver.sources(universe, now) == 0) std::abort();
      // The only source, without synchronisation, shows the levels it sent.
      if (receiver.sources(universe, now) == 1 && decoded->sync_universe == 0) {
        const auto levels = receiver.levels(universe, now);
        if (!levels || !std::equal(decoded->slots.begin(), decoded->slots.end(), levels->begin())) std::abort();
      }
    }
    const Time later = now + SacnReceiver::kLossTimeout + std::chrono::milliseconds(1);
    if (verdict == SacnReceiver::Verdict::terminated) {
      SacnReceiver copy = receiver;
      if (copy.sources(universe, later) != 0 || copy.levels(universe, later) != receiver.levels(universe, now)) {
        std::abort();
      }
    }
  }
  return 0;
}
