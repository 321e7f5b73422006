/// The ENTTEC stream decoder: a stream cut anywhere gives the same messages, and each message encodes back to its own
/// bytes. First byte: size of the pieces. The session takes the stream, too, and never sends more than a bulk transfer
/// holds.
#include <algorithm>
#include <cstdlib>

#include "drivers/dmx/enttec_pro/widget_session.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace luxrig;
  using namespace luxrig::enttec;
  if (size == 0) return 0;
  const std::size_t piece = 1 + data[0];
  const std::span<const std::uint8_t> stream(data + 1, size - 1);

  StreamDecoder whole, cut;
  std::vector<Message> at_once, piecewise;
  whole.add(stream);
  while (auto message = whole.next()) at_once.push_back(std::move(*message));
  WidgetSession session({0, 17, 2, 40});
  Time now{};
  session.start(now);
  for (std::size_t at = 0; at < stream.size(); at += piece) {
    const auto bytes = stream.subspan(at, std::min(piece, stream.size() - at));
    cut.add(bytes);
    while (auto message = cut.next()) piecewise.push_back(std::move(*message));
    now += std::chrono::milliseconds(data[0]);
    session.receive(now, bytes);
    if (session.due(now, DmxSlots{}).size() > 1024) std::abort();
  }
  if (at_once != piecewise || whole.dropped() != cut.dropped()) std::abort();

  std::size_t encoded = 0;
  for (const Message& message : at_once) {
    if (message.data.size() > kMaxData) std::abort();
    const auto bytes = encode(static_cast<Label>(message.label), message.data);
    if (std::search(stream.begin(), stream.end(), bytes.begin(), bytes.end()) == stream.end()) std::abort();
    encoded += bytes.size();
  }
  if (encoded + whole.dropped() > stream.size()) std::abort();
  return 0;
}
