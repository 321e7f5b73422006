#include "drivers/dmx/artnet/artnet_driver.h"

#include <fmt/format.h>

#include <algorithm>

#include "drivers/dmx/artnet/artnet_controller.h"
#include "drivers/dmx/artnet/artnet_receiver.h"
#include "drivers/dmx/udp_dmx_driver.h"
#include "drivers/io/host_id.h"
#include "drivers/io/udp.h"
#include "drivers/options.h"

namespace luxrig {
namespace {

constexpr OptionDoc kOptions[] = {
    {"destination", "text", "", "\"auto\"", "\"auto\", or an IPv4 address",
     "where ArtDmx goes: to every node that says it puts the universe out, or to this one address"},
    {"broadcast", "text", "", "\"255.255.255.255\"", "an IPv4 address",
     "where \"auto\" asks for nodes: the broadcast address of the lighting network"},
    {"expect_reply", "true or false", "", "true", "",
     "false: the receiver at destination does not answer ArtPoll, and its silence is no fault"},
    {"continuous", "true or false", "", "false", "", "send every cycle; false: changes at once, the rest every second"},
    {"sync", "true or false", "", "false", "",
     "ArtSync after each frame: nodes that have several of its universes change them together"},
    {"sequence", "true or false", "", "true", "",
     "number the packets, so that nodes drop what comes out of order; false for nodes that cannot count"},
    kInputOption,
    kInputHandBackOption,
    kInputOffsetOption,
    kInputMergeOption,
    {"input_port", "whole number", "", "6454", "1 to 65535", "UDP port on which a desk is heard"},
};

std::vector<std::unique_ptr<DatagramChannel>> alone(std::unique_ptr<DatagramChannel> channel) {
  std::vector<std::unique_ptr<DatagramChannel>> channels;
  channels.push_back(std::move(channel));
  return channels;
}

class ArtnetDriver final : public UdpDmxDriver {
 public:
  ArtnetDriver(std::unique_ptr<DatagramChannel> channel, const Rig& rig, std::size_t bus,
               const std::optional<Redirect>& redirect)
      : UdpDmxDriver(alone(std::move(channel)), rig, bus, desk_options(rig.buses[bus], kOptions)),
        controller_({boolean_option(rig.buses[bus], kOptions, "continuous"),
                     boolean_option(rig.buses[bus], kOptions, "sequence"),
                     boolean_option(rig.buses[bus], kOptions, "sync")}) {
    const Bus& entry = rig.buses[bus];
    expect_reply_ = boolean_option(entry, kOptions, "expect_reply");
    poll_to_ = {parse_ipv4(string_option(entry, kOptions, "broadcast")).value_or(0xFFFFFFFF), artnet::kPort};
    if (redirect) {
      destination_ =
          SocketAddress{parse_ipv4(redirect->host).value_or(0x7F000001), static_cast<std::uint16_t>(redirect->port)};
    } else if (const auto address = parse_ipv4(string_option(entry, kOptions, "destination"))) {
      destination_ = SocketAddress{*address, artnet::kPort};
    }
    if (destination_) poll_to_ = *destination_;
    rig_name_ = rig.name;
    everywhere_ = destination_ && (destination_->ipv4 == 0xFFFFFFFF ||
                                   destination_->ipv4 == parse_ipv4(string_option(entry, kOptions, "broadcast")));
  }
  ~ArtnetDriver() override { close(); }

  DriverBounds bounds() const override {
    DriverBounds bounds;
    bounds.write = write_bound();
    bounds.write_period = kDmxWritePeriod;
    bounds.fault_after = artnet::kNodeGone + 2 * kDmxWritePeriod;
    bounds.notices_loss = expect_reply_ || !destination_;
    return bounds;
  }

  std::vector<Health> health(Time) const override {
    std::vector<Health> all{life_.health()};
    for (const auto& [address, node] : controller_.nodes()) {
      Health health;
      health.device = fmt::format("{}: {} ({})", life_.health().device, node.name, text_of(address.ipv4));
      // A node without our universes may come and go: desks, and nodes of other shows.
      health.life = !node.gone ? Life::active : puts_out_ours(address, node) ? Life::faulted : Life::configured;
      if (node.gone) health.detail = "timeout: three polls without an answer";
      if (!node.gone && merges_ours(node)) health.detail = "merges this bus's data with another sender's";
      health.since = node.since;
      health.last_ok = node.last_seen;
      health.received = node.replies;
      all.push_back(std::move(health));
    }
    return all;
  }

 private:
  void begin(Time now) override {
    activated_ = now;
    if (!desk().rules || receiver_) return;
    const std::string host = host_id();
    const std::string_view parts[] = {"luxrig artnet", host, rig_name_, life_.health().device};
    const auto id = hashed_id(parts);
    artnet::ReceiverSettings settings;
    settings.port_addresses = desk_universes();
    settings.rule = desk().merge;
    settings.short_name = "Luxrig";
    settings.long_name = fmt::format("Luxrig {}, {}", rig_name_, life_.health().device);
    std::copy_n(id.begin(), mac_.size(), mac_.begin());
    mac_[0] = static_cast<std::uint8_t>((mac_[0] & 0xFC) | 0x02);  // locally administered, unique to the host
    settings.mac = mac_;
    settings.reply_delay = std::chrono::milliseconds(1000 * id[6] / 256);
    receiver_.emplace(std::move(settings));
  }
  bool has_answers() const override { return true; }
  void rest() override {
    controller_.rest();
    if (receiver_) receiver_->restart();
  }

  void hear(Time now, const Datagram& datagram) override {
    if (receiver_) {
      // Ignore its own answer to its own poll, or it would send to itself and follow that.
      const auto reply = artnet::decode_poll_reply(datagram.bytes);
      if (reply && reply->mac == mac_) return;
      if (everywhere_ && is_own(datagram.from)) return;
      using Verdict = artnet::Receiver::Verdict;
      if (receiver_->receive(now, datagram.from, datagram.bytes) == Verdict::taken) return life_.count_received(now);
    }
    if (controller_.hear(now, datagram)) life_.count_received(now);
  }

  HeardUniverse heard(Time now, int port_address) override {
    return receiver_ ? receiver_->heard(now, port_address) : HeardUniverse{};
  }

  bool is_own(const SocketAddress& from) {
    const auto [known, is_new] = own_addresses_.try_emplace(from.ipv4, false);
    if (is_new) known->second = local_address_towards(from.ipv4) == from.ipv4;
    return known->second && from.port == desk().port;
  }

  /// Without this, nodes keep merging the last data for 10 s.
  void fall_silent(Time now, const DmxUniverse& universe) override {
    for (const auto& [address, node] : controller_.nodes()) {
      for (const auto& [bind_index, outputs] : node.outputs) {
        const bool puts_out = std::any_of(outputs.begin(), outputs.end(), [&](const artnet::PortOutput& port) {
          return port.port_address == universe.number;
        });
        if (node.gone || !puts_out) continue;
        send(now, address, artnet::encode(artnet::Address{bind_index, artnet::AddressCommand::cancel_merge, 0}));
      }
    }
  }

  void send_frame(Time now) override {
    if (controller_.poll_due(now)) send(now, poll_to_, artnet::encode_poll());
    if (receiver_) {
      for (const auto& [to, reply] : receiver_->answers_due(now)) {
        send(now, to, artnet::encode(reply, local_address_towards(to.ipv4)));
      }
    }
    for (std::size_t i = 0; i < bay_.universes().size(); ++i) {
      if (!is_silent(i)) send_universe(now, bay_.universes()[i]);
    }
    if (const auto packet = controller_.sync_due()) send(now, poll_to_, *packet);
  }

  [[nodiscard]] bool is_sent(const DmxUniverse& universe) const override {
    return (destination_ || !controller_.subscribers(universe.number).empty()) &&
           controller_.is_sent(universe.number, universe.slots);
  }

  void send_universe(Time now, const DmxUniverse& universe) {
    if (destination_) {
      if (const auto packet = controller_.due(now, universe.number, universe.slots)) send(now, *destination_, *packet);
      return;
    }
    const std::vector<SocketAddress> nodes = controller_.subscribers(universe.number);
    if (nodes.empty()) return;
    const auto packet = controller_.due(now, universe.number, universe.slots);
    if (!packet) return;
    for (const SocketAddress& node : nodes) send(now, node, *packet);
  }

  bool puts_out_ours(const SocketAddress& address, const artnet::Node& node) const {
    if (destination_ && !everywhere_ && address.ipv4 != destination_->ipv4) return false;
    return std::any_of(bay_.universes().begin(), bay_.universes().end(),
                       [&](const DmxUniverse& universe) { return node.puts_out(universe.number); });
  }

  bool merges_ours(const artnet::Node& node) const {
    return std::any_of(bay_.universes().begin(), bay_.universes().end(),
                       [&](const DmxUniverse& universe) { return node.merges(universe.number); });
  }

  std::optional<std::string> missing(Time now) const override {
    if (!expect_reply_ && destination_) return std::nullopt;
    if (destination_) {
      Time last = activated_;
      std::string name = "the node at " + text_of(*destination_);
      for (const auto& [address, node] : controller_.nodes()) {
        if (address.ipv4 != destination_->ipv4) continue;
        last = std::max(last, node.last_seen);
        name = fmt::format("node \"{}\" at {}", node.name, text_of(*destination_));
      }
      if (now - last <= artnet::kNodeGone) return std::nullopt;
      return fmt::format("{} has answered no poll for {:.1f} s", name, to_seconds(now - last));
    }
    if (now - activated_ <= artnet::kNodeGone) return std::nullopt;
    for (const DmxUniverse& universe : bay_.universes()) {
      if (!controller_.subscribers(universe.number).empty()) continue;
      for (const auto& [address, node] : controller_.nodes()) {
        if (node.gone && node.puts_out(universe.number)) {
          return fmt::format("node \"{}\" at {} has answered no poll for {:.1f} s", node.name, text_of(address),
                             to_seconds(now - node.last_seen));
        }
      }
      return fmt::format("no node puts out universe {} ({})", universe.number,
                         artnet::text_of_port_address(universe.number));
    }
    return std::nullopt;
  }

  artnet::Controller controller_;
  bool expect_reply_ = true;
  SocketAddress poll_to_;
  std::optional<SocketAddress> destination_;  ///< empty = to subscribers
  Time activated_{};
  std::string rig_name_;
  bool everywhere_ = false;  ///< destination_ is a broadcast address, so our packets come back to us
  std::optional<artnet::Receiver> receiver_;
  std::array<std::uint8_t, 6> mac_{};
  std::map<std::uint32_t, bool> own_addresses_;
};

}  // namespace

std::span<const OptionDoc> artnet_options() { return kOptions; }

std::vector<Problem> check_artnet(const Rig& rig, std::size_t bus) {
  const Bus& entry = rig.buses[bus];
  std::vector<Problem> problems = check_options(rig, entry, kOptions);
  std::vector<Problem> patch = check_dmx_patch(rig, bus, 0, artnet::kHighestPortAddress);
  if (problems.empty()) {
    const auto check_address = [&](std::string_view key, const std::string& text) {
      const auto address = parse_ipv4(text);
      if (address && *address != 0 && !is_multicast(*address)) return;
      problems.push_back(problem_at(rig, entry, key,
                                    fmt::format("{} = \"{}\" is no IPv4 address to send to", key, text),
                                    "write numbers, such as \"2.0.0.10\""));
    };
    const auto of_desk = check_desk_options(rig, bus, kOptions, 0, artnet::kHighestPortAddress);
    problems.insert(problems.end(), of_desk.begin(), of_desk.end());
    const std::string destination = string_option(entry, kOptions, "destination");
    if (destination != "auto") check_address("destination", destination);
    check_address("broadcast", string_option(entry, kOptions, "broadcast"));
    if (destination == "auto" && !boolean_option(entry, kOptions, "expect_reply")) {
      problems.push_back(problem_at(rig, entry, "expect_reply",
                                    "expect_reply = false needs a destination: \"auto\" finds nodes by their replies",
                                    "write destination = the node's IPv4 address"));
    }
  }
  problems.insert(problems.end(), patch.begin(), patch.end());
  return problems;
}

std::unique_ptr<Driver> make_artnet_over(std::unique_ptr<DatagramChannel> channel, const Rig& rig, std::size_t bus,
                                         const std::optional<Redirect>& redirect) {
  return std::make_unique<ArtnetDriver>(std::move(channel), rig, bus, redirect);
}

std::unique_ptr<Driver> make_artnet(const Rig& rig, std::size_t bus, const std::optional<Redirect>& redirect) {
  UdpSettings settings;
  settings.broadcast = true;
  if (!redirect) {
    settings.local_port = artnet::kPort;  // nodes answer to this port, some by broadcast
    settings.share_local_port = true;
  }
  if (const DeskOptions desk = desk_options(rig.buses[bus], kOptions); desk.rules) {
    settings.local_port =
        redirect && redirect->desk_port > 0 ? static_cast<std::uint16_t>(redirect->desk_port) : desk.port;
    settings.share_local_port = true;
  }
  return make_artnet_over(make_udp(std::move(settings)), rig, bus, redirect);
}

WhenDataStops artnet_when_data_stops(const Rig&, std::size_t) {
  return {WithoutData::holds, std::nullopt, "the node, which goes on sending (Art-Net 4: failsafe, by default hold)"};
}

}  // namespace luxrig
