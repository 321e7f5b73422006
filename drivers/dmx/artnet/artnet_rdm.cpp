#include "drivers/dmx/artnet/artnet_rdm.h"

namespace luxrig::artnet {
namespace {

constexpr int kDatagramsPerListen = 256;
constexpr std::size_t kMaxAnswers = 64;  // a client takes them every few milliseconds

}  // namespace

ArtnetRdmLink::ArtnetRdmLink(DatagramChannel& channel, SocketAddress node, int port_address)
    : channel_(channel), node_(node), port_address_(port_address) {}

Result<void> ArtnetRdmLink::ask_table() {
  const int ports[] = {port_address_};
  return channel_.send(node_, encode_tod_request(ports));
}

Result<void> ArtnetRdmLink::flush_table() {
  table_ = {};
  blocks_.clear();
  total_ = 0;
  return channel_.send(node_, encode(TodControl{port_address_, TodCommand::flush}));
}

void ArtnetRdmLink::listen() {
  while (channel_.take_error()) {
  }
  for (int i = 0; i < kDatagramsPerListen; ++i) {
    const auto datagram = channel_.receive();
    if (!datagram) break;
    (void)hear(*datagram);
  }
}

bool ArtnetRdmLink::hear(const Datagram& datagram) {
  if (datagram.from.ipv4 != node_.ipv4) return false;
  if (const auto data = decode_tod_data(datagram.bytes)) {
    if (data->port_address != port_address_) return false;
    take(*data);
    return true;
  }
  auto carried = decode_art_rdm(datagram.bytes);
  if (!carried || carried->port_address != port_address_) return false;
  if (answers_.size() < kMaxAnswers) answers_.push_back(std::move(carried->rdm));
  return true;
}

void ArtnetRdmLink::take(const TodData& data) {
  table_.heard = true;
  if (!data.full) return;
  // Block 0, or another total, starts a new table.
  if (data.block == 0 || data.total != total_) blocks_.clear();
  total_ = data.total;
  blocks_[data.block] = data.uids;
  std::size_t count = 0;
  for (const auto& [block, uids] : blocks_) {
    count += uids.size();
    table_.uids.insert(uids.begin(), uids.end());
  }
  table_.complete = count >= static_cast<std::size_t>(total_);
  if (!table_.complete) return;
  table_.uids.clear();  // drop devices that only an older table had
  for (const auto& [block, uids] : blocks_) table_.uids.insert(uids.begin(), uids.end());
}

Result<void> ArtnetRdmLink::send(Time, std::span<const std::uint8_t> packet) {
  return channel_.send(node_, encode(ArtRdm{port_address_, {packet.begin(), packet.end()}}));
}

std::optional<std::vector<std::uint8_t>> ArtnetRdmLink::receive(Time) {
  listen();
  if (answers_.empty()) return std::nullopt;
  auto answer = std::move(answers_.front());
  answers_.pop_front();
  return answer;
}

}  // namespace luxrig::artnet
