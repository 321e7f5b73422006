/// The sACN receiver: input = packets, each with the delay since the last. It tracks a bounded number of sources, joins
/// a bounded number of groups, never shows preview or its own data, and forgets silent sources. The decoders of
/// synchronisation and discovery accept only packets that encode to the same bytes again.
#include <algorithm>
#include <cstdlib>
#include <vector>

#include "drivers/dmx/sacn/sacn_receiver.h"

namespace {

using namespace luxrig;
using namespace luxrig::sacn;

/// Except the bytes after the NUL of a name, and reserved bytes.
void check_decoders(std::span<const std::uint8_t> bytes) {
  if (const auto sync = decode_sync(bytes)) {
    const auto again = decode_sync(encode(*sync));
    if (!again || again->cid != sync->cid || again->sequence != sync->sequence ||
        again->sync_universe != sync->sync_universe) {
      std::abort();
    }
  }
  if (const auto list = decode_discovery(bytes)) {
    const auto encoded = encode(*list);
    const auto again = decode_discovery(encoded);
    if (encoded.size() != bytes.size() || !again || again->universes != list->universes || again->page != list->page) {
      std::abort();
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ReceiverSettings settings;
  settings.universes = {1, 2};
  settings.own = Cid{0xEE};
  if (size > 0) settings.rule = data[0] % 2 == 0 ? MergeRule::htp : MergeRule::ltp;
  Receiver receiver(settings);
  Time now{};
  std::span<const std::uint8_t> rest(data, size);
  // Record: delay in units of 10 ms, length of the packet (two bytes), packet.
  while (rest.size() >= 3) {
    now += std::chrono::milliseconds(10 * rest[0]);
    const std::size_t length = std::min<std::size_t>(rest[1] << 8 | rest[2], rest.size() - 3);
    // On the heap, so that a read past its end is found.
    const std::vector<std::uint8_t> packet(rest.begin() + 3, rest.begin() + 3 + static_cast<std::ptrdiff_t>(length));
    rest = rest.subspan(3 + length);
    check_decoders(packet);
    const auto verdict = receiver.receive(now, packet);
    if (const auto decoded = decode(packet)) {
      const bool foreign = decoded->universe != 1 && decoded->universe != 2;
      if ((foreign || decoded->cid == *settings.own) && verdict != Receiver::Verdict::ignored) std::abort();
      if (decoded->preview && verdict == Receiver::Verdict::taken) std::abort();
    }
    for (const int universe : settings.universes) {
      if (receiver.sources(now, universe) > 16) std::abort();
      const HeardUniverse heard = receiver.heard(now, universe);
      if (heard.presence == DeskPresence::present && receiver.sources(now, universe) == 0) std::abort();
    }
    if (receiver.groups().size() > 70) std::abort();
  }
  // Twice the timeout: the loss of one source may wait for that of another.
  for (int i = 0; i < 2; ++i) now += kSourceLoss + std::chrono::milliseconds(1);
  for (const int universe : settings.universes) {
    if (receiver.heard(now, universe).presence == DeskPresence::present) std::abort();
  }
  return 0;
}
