#include "drivers/dmx/sacn/sacn_driver.h"

#include <fmt/format.h>

#include <algorithm>

#include "drivers/dmx/sacn/sacn_receiver.h"
#include "drivers/dmx/sacn/sacn_source.h"
#include "drivers/dmx/udp_dmx_driver.h"
#include "drivers/io/host_id.h"
#include "drivers/io/udp.h"
#include "drivers/options.h"

namespace luxrig {
namespace {

constexpr OptionDoc kSacnOptions[] = {
    {"destination", "text", "", "\"multicast\"", "\"multicast\", or IPv4 addresses with commas between them",
     "where packets go: each universe to its multicast group 239.255.x.y, or all to each of these receivers"},
    {"port", "whole number", "", "5568", "1 to 65535", "UDP port of the receivers"},
    {"interface", "text", "", "\"\"", "names (eth0) or IPv4 addresses of interfaces, with commas between them",
     "network interfaces that multicast leaves by, all of them; empty: the system chooses one"},
    {"ttl", "whole number", "hops", "8", "1 to 255", "how many routers a multicast packet may pass"},
    {"priority", "whole number", "", "100", "0 to 200", "the source with the highest priority wins at the receiver"},
    {"slot_priority", "true or false", "", "false", "",
     "say the priority slot by slot (start code 0xDD): `priority` where a fixture uses the slot, nothing elsewhere, so "
     "that other slots of the universe stay another source's"},
    {"source_name", "text", "", "\"\"", "at most 63 bytes of UTF-8",
     "what receivers show as the sender; empty: Luxrig and the rig's name"},
    {"cid", "text", "", "\"\"", "a UUID, 8-4-4-4-12 hexadecimal digits",
     "component identifier; empty: derived from host, rig and bus, the same after every restart"},
    {"continuous", "true or false", "", "true", "",
     "send every cycle; false: only changes, three repeats, then a keep-alive every 0.88 s"},
    {"sync_universe", "whole number", "", "0", "0 to 63999",
     "receivers hold all universes of a frame until a synchronisation packet to this one; 0: each acts at once"},
    {"preview", "true or false", "", "false", "", "mark all data as preview: visualisers show it, lamps do not"},
    kInputOption,
    kInputHandBackOption,
    kInputOffsetOption,
    kInputMergeOption,
    {"input_port", "whole number", "", "5568", "1 to 65535", "UDP port on which a desk is heard"},
};

constexpr int kGoodbyes = 3;  // clause 6.2.6
constexpr Duration kJoinAgainEvery = std::chrono::seconds(1);

class SacnDriver final : public UdpDmxDriver {
 public:
  SacnDriver(std::vector<std::unique_ptr<DatagramChannel>> channels, const Rig& rig, std::size_t bus,
             const std::optional<Redirect>& redirect)
      : UdpDmxDriver(std::move(channels), rig, bus, desk_options(rig.buses[bus], kSacnOptions)) {
    const Bus& entry = rig.buses[bus];
    rig_name_ = rig.name;
    port_ = static_cast<std::uint16_t>(integer_option(entry, kSacnOptions, "port"));
    for (const std::string& address : list_in(string_option(entry, kSacnOptions, "destination"))) {
      if (const auto ipv4 = parse_ipv4(address)) unicast_.push_back(*ipv4);
    }
    if (redirect) {
      unicast_ = {parse_ipv4(redirect->host).value_or(0x7F000001)};
      port_ = static_cast<std::uint16_t>(redirect->port);
    }
    settings_.priority = static_cast<int>(integer_option(entry, kSacnOptions, "priority"));
    settings_.continuous = boolean_option(entry, kSacnOptions, "continuous");
    settings_.preview = boolean_option(entry, kSacnOptions, "preview");
    settings_.sync_universe = static_cast<int>(integer_option(entry, kSacnOptions, "sync_universe"));
    settings_.source_name = string_option(entry, kSacnOptions, "source_name");
    if (settings_.source_name.empty()) settings_.source_name = "Luxrig " + rig.name;
    slot_priority_ = boolean_option(entry, kSacnOptions, "slot_priority");
    cid_ = sacn::parse_cid(string_option(entry, kSacnOptions, "cid"));
    joins_must_succeed_ = !redirect;
  }
  ~SacnDriver() override { close(); }

  DriverBounds bounds() const override {
    DriverBounds bounds;
    bounds.write = write_bound();
    bounds.write_period = kDmxWritePeriod;
    bounds.fault_after = std::chrono::milliseconds(500);
    bounds.notices_loss = !unicast_.empty();
    return bounds;
  }

 private:
  void begin(Time) override {
    if (source_) return;
    settings_.cid = cid_.value_or(sacn::derive_cid(host_id(), rig_name_, life_.health().device));
    source_.emplace(settings_);
    if (desk().rules) {
      sacn::ReceiverSettings heard;
      heard.universes = desk_universes();
      heard.own = settings_.cid;
      heard.rule = desk().merge;
      // In standby, Luxrig yields to sources that receivers prefer, so it ignores those of lower priority.
      if (desk().rules->mode == DeskMode::standby) heard.lowest_priority = settings_.priority;
      receiver_.emplace(std::move(heard));
    }
    if (!slot_priority_) return;
    for (std::size_t i = 0; i < bay_.universes().size(); ++i) {
      DmxSlots priorities = bay_.used_slots(i);
      // 0 would mean that this source has no value there, so priority = 0 becomes 1.
      const int priority = std::max(1, settings_.priority);
      for (std::uint8_t& slot : priorities) slot = static_cast<std::uint8_t>(slot * priority);
      source_->set_slot_priorities(bay_.universes()[i].number, priorities);
    }
  }

  void send_frame(Time now) override {
    for (std::size_t i = 0; i < bay_.universes().size(); ++i) {
      const DmxUniverse& universe = bay_.universes()[i];
      if (is_silent(i)) continue;
      if (const auto packet = source_->due(now, universe.number, universe.slots)) {
        send_to(now, universe.number, *packet);
      }
    }
    if (const auto packet = source_->sync_due()) send_to(now, settings_.sync_universe, *packet);
    for (const auto& page : source_->discovery_due(now)) send_to(now, sacn::kDiscoveryUniverse, page);
  }

  [[nodiscard]] bool is_sent(const DmxUniverse& universe) const override {
    return source_->is_sent(universe.number, universe.slots);
  }

  void say_goodbye(Time now) override {
    for (int i = 0; i < kGoodbyes; ++i) {
      for (const DmxUniverse& universe : bay_.universes()) {
        if (const auto packet = source_->goodbye(universe.number)) send_to(now, universe.number, *packet);
      }
    }
  }

  void fall_silent(Time now, const DmxUniverse& universe) override {
    for (int i = 0; i < kGoodbyes; ++i) {
      if (const auto packet = source_->goodbye(universe.number)) send_to(now, universe.number, *packet);
    }
    source_->rest(universe.number);
  }

  void rest() override {
    if (source_) source_->rest();
    if (receiver_) receiver_->restart();
  }

  void hear(Time now, const Datagram& datagram) override {
    if (receiver_ && receiver_->receive(now, datagram.bytes) == sacn::Receiver::Verdict::taken) {
      life_.count_received(now);
    }
  }

  HeardUniverse heard(Time now, int universe) override {
    if (!receiver_) return {};
    join_groups(now);
    return receiver_->heard(now, universe);
  }

  /// The desk's universes, and their synchronisation universes. A reopened channel has joined none yet.
  void join_groups(Time now) {
    if (now < join_again_at_) return;
    for (const auto& channel : channels()) {
      if (!channel->is_open()) continue;
      for (const int universe : receiver_->groups()) {
        const auto joined = channel->join(sacn::multicast_group(static_cast<std::uint16_t>(universe)));
        if (joined) continue;
        join_again_at_ = now + kJoinAgainEvery;
        // With a stand-in, on a host perhaps without a network, a desk can still send to this host alone.
        if (joins_must_succeed_) note_error(now, joined.error());
        return;
      }
    }
  }

  void send_to(Time now, int universe, std::span<const std::uint8_t> packet) {
    if (unicast_.empty()) {
      return send(now, {sacn::multicast_group(static_cast<std::uint16_t>(universe)), port_}, packet);
    }
    for (const std::uint32_t receiver : unicast_) send(now, {receiver, port_}, packet);
  }

  std::string rig_name_;
  std::vector<std::uint32_t> unicast_;  ///< empty = multicast
  std::uint16_t port_ = 0;
  std::optional<sacn::Cid> cid_;
  sacn::SourceSettings settings_;
  bool slot_priority_ = false, joins_must_succeed_ = true;
  Time join_again_at_{};
  std::optional<sacn::Source> source_;
  std::optional<sacn::Receiver> receiver_;
};

bool is_receiver_address(const std::string& text) {
  const auto address = parse_ipv4(text);
  return address && *address != 0 && !is_multicast(*address) && *address != 0xFFFFFFFF;
}

bool may_name_an_interface(const std::string& text) {
  return !text.empty() && text.size() <= 15 && text.find_first_of(" /") == std::string::npos;
}

}  // namespace

std::span<const OptionDoc> sacn_options() { return kSacnOptions; }

std::vector<Problem> check_sacn(const Rig& rig, std::size_t bus) {
  const Bus& entry = rig.buses[bus];
  std::vector<Problem> problems = check_options(rig, entry, kSacnOptions);
  std::vector<Problem> patch = check_dmx_patch(rig, bus, sacn::kLowestUniverse, sacn::kHighestUniverse);
  if (problems.empty()) {
    const auto report = [&](std::string_view key, std::string what, std::string mend) {
      problems.push_back(problem_at(rig, entry, key, std::move(what), std::move(mend)));
    };
    const std::string destination = string_option(entry, kSacnOptions, "destination");
    const std::vector<std::string> receivers = list_in(destination);
    if (destination != "multicast" &&
        (receivers.empty() || !std::all_of(receivers.begin(), receivers.end(), is_receiver_address))) {
      report("destination",
             fmt::format("destination = \"{}\" is neither \"multicast\" nor receivers' IPv4 addresses", destination),
             "write \"multicast\", or addresses such as \"192.168.1.20, 192.168.1.21\"");
    }
    const std::string interface = string_option(entry, kSacnOptions, "interface");
    const std::vector<std::string> interfaces = list_in(interface);
    if (!std::all_of(interfaces.begin(), interfaces.end(), may_name_an_interface)) {
      report("interface", fmt::format("interface = \"{}\" cannot be names of network interfaces", interface),
             "write names as `ip link` lists them, such as \"eth0\", or their IPv4 addresses");
    }
    const auto of_desk = check_desk_options(rig, bus, kSacnOptions, sacn::kLowestUniverse, sacn::kHighestUniverse);
    problems.insert(problems.end(), of_desk.begin(), of_desk.end());
    const std::string cid = string_option(entry, kSacnOptions, "cid");
    if (!cid.empty() && !sacn::parse_cid(cid)) {
      report("cid", fmt::format("cid = \"{}\" is not a UUID", cid),
             "write one as `uuidgen` prints it, or leave the option out");
    }
    const std::string source_name = string_option(entry, kSacnOptions, "source_name");
    if (source_name.size() >= sacn::kSourceNameBytes) {
      report("source_name", fmt::format("source_name has {} bytes", source_name.size()), "keep it to 63 bytes");
    }
  }
  problems.insert(problems.end(), patch.begin(), patch.end());
  return problems;
}

std::unique_ptr<Driver> make_sacn_over(std::vector<std::unique_ptr<DatagramChannel>> channels, const Rig& rig,
                                       std::size_t bus, const std::optional<Redirect>& redirect) {
  return std::make_unique<SacnDriver>(std::move(channels), rig, bus, redirect);
}

std::unique_ptr<Driver> make_sacn(const Rig& rig, std::size_t bus, const std::optional<Redirect>& redirect) {
  UdpSettings settings;
  settings.multicast_ttl = static_cast<int>(integer_option(rig.buses[bus], kSacnOptions, "ttl"));
  std::vector<std::string> interfaces = list_in(string_option(rig.buses[bus], kSacnOptions, "interface"));
  // A stand-in on loopback needs none of the real network's interfaces, which may not exist. And unicast is routed by
  // the system, so a second channel would only send it twice.
  const bool multicast = string_option(rig.buses[bus], kSacnOptions, "destination") == "multicast";
  if (redirect) interfaces.clear();
  if (const DeskOptions desk = desk_options(rig.buses[bus], kSacnOptions); desk.rules) {
    settings.local_port =
        redirect && redirect->desk_port > 0 ? static_cast<std::uint16_t>(redirect->desk_port) : desk.port;
    settings.share_local_port = true;
  }
  if (interfaces.empty() || !multicast) interfaces.resize(1);
  std::vector<std::unique_ptr<DatagramChannel>> channels;
  for (const std::string& interface : interfaces) {
    settings.multicast_interface = interface;
    channels.push_back(make_udp(settings));
  }
  return make_sacn_over(std::move(channels), rig, bus, redirect);
}

WhenDataStops sacn_when_data_stops(const Rig&, std::size_t) {
  return {WithoutData::makers_choice, to_seconds(sacn::kSourceLoss),
          "E1.31-2018 6.7.1: the source is lost after 2.5 s"};
}

}  // namespace luxrig
