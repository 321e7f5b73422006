/// Both ends of a wire: the drivers' codecs against the simulator's own reading, which was written without them. They
/// must take and refuse the same packets, and read the same values in them. First byte: which wire. The rest makes
/// values for the driver's encoder, then edits of its bytes.
#include <algorithm>
#include <cstdint>
#include <map>
#include <vector>

#include "core/check.h"
#include "drivers/can/can_frame.h"
#include "drivers/can/canopen/sdo_codec.h"
#include "drivers/dmx/artnet/artnet_codec.h"
#include "drivers/dmx/enttec_pro/enttec_codec.h"
#include "drivers/dmx/rdm/rdm_discovery.h"
#include "drivers/dmx/rdm/rdm_packet.h"
#include "drivers/dmx/sacn/sacn_codec.h"
#include "drivers/modbus/modbus_codec.h"
#include "sim/devices/rdm_frame.h"
#include "sim/devices/usb/enttec_widget.h"
#include "sim/wire/artnet/artnet_node.h"
#include "sim/wire/can/axis_node.h"
#include "sim/wire/modbus/modbus_session.h"
#include "sim/wire/sacn/sacn_receiver.h"

namespace luxrig {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Values from the input; zeros after its end.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : rest_(data, size) {}
  std::uint8_t byte() {
    if (rest_.empty()) return 0;
    const std::uint8_t next = rest_.front();
    rest_ = rest_.subspan(1);
    return next;
  }
  unsigned word() {
    const unsigned high = byte();
    return high << 8 | byte();
  }
  /// From 0 to `max`.
  std::size_t up_to(std::size_t max) { return word() % (max + 1); }
  Bytes bytes(std::size_t count) {
    Bytes out(count);
    for (std::uint8_t& one : out) one = byte();
    return out;
  }
  [[nodiscard]] bool ended() const { return rest_.empty(); }

 private:
  std::span<const std::uint8_t> rest_;
};

/// Up to eight bytes are changed, then it is cut or grows.
Bytes edited(Bytes packet, Input& in) {
  for (int k = 0; k < 8 && !in.ended(); ++k) {
    const std::size_t at = in.up_to(packet.size() - 1);
    packet[at] = in.byte();
  }
  if (!in.ended() && in.byte() % 4 == 0) packet.resize(in.up_to(packet.size() + 4));
  return packet;
}

bool same(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end());
}

void sacn_data(Input& in) {
  sacn::DataPacket sent;
  sent.priority = in.byte() % (sacn::kHighestPriority + 1);
  sent.sync_universe = static_cast<std::uint16_t>(in.word());
  sent.sequence = in.byte();
  const std::uint8_t flags = in.byte();
  sent.preview = (flags & 1) != 0;
  sent.terminated = (flags & 2) != 0;
  sent.force_sync = (flags & 4) != 0;
  sent.universe = static_cast<std::uint16_t>(1 + in.up_to(sacn::kHighestUniverse - 1));
  sent.start_code = in.byte();
  for (std::size_t k = in.byte() % sacn::kSourceNameBytes; k > 0; --k)
    sent.source_name += static_cast<char>(1 + in.byte() % 255);
  sent.slots = in.bytes(in.up_to(512));
  const Bytes packet = edited(sacn::encode(sent), in);
  const auto ours = sacn::decode(packet);
  const auto theirs = sim::decode_sacn_data(packet);
  LUXRIG_CHECK(ours.has_value() == theirs.has_value(), "sACN of {} bytes: ours {}, the gateway's {}", packet.size(),
               ours.has_value(), theirs.has_value());
  if (!ours) return;
  LUXRIG_CHECK(ours->cid == theirs->cid && ours->priority == theirs->priority && ours->sequence == theirs->sequence &&
                   ours->sync_universe == theirs->sync_universe && ours->universe == theirs->universe &&
                   ours->preview == theirs->preview && ours->terminated == theirs->terminated &&
                   ours->force_sync == theirs->force_sync && ours->start_code == theirs->start_code &&
                   ours->source_name == theirs->source_name && same(ours->slots, theirs->slots),
               "sACN read differently, universe {} and {}", ours->universe, theirs->universe);
}

void sacn_sync(Input& in) {
  sacn::SyncPacket sent;
  sent.sequence = in.byte();
  sent.sync_universe = static_cast<std::uint16_t>(1 + in.up_to(sacn::kHighestUniverse - 1));
  const Bytes packet = edited(sacn::encode(sent), in);
  const auto ours = sacn::decode_sync(packet);
  const auto theirs = sim::decode_sacn_sync(packet);
  LUXRIG_CHECK(ours.has_value() == theirs.has_value(), "sACN synchronisation of {} bytes: ours {}, the gateway's {}",
               packet.size(), ours.has_value(), theirs.has_value());
  LUXRIG_CHECK(!ours || (ours->cid == theirs->cid && ours->sequence == theirs->sequence &&
                         ours->sync_universe == theirs->sync_universe),
               "sACN synchronisation read differently");
}

void artnet_packet(Input& in) {
  artnet::Dmx sent;
  sent.sequence = in.byte();
  sent.port_address = static_cast<int>(in.up_to(artnet::kHighestPortAddress));
  sent.slots = in.bytes(2 + 2 * in.up_to(255));
  const std::uint8_t which = in.byte();
  const Bytes packet = edited(which % 4 == 0   ? artnet::encode_poll()
                              : which % 4 == 1 ? artnet::encode_sync()
                                               : artnet::encode(sent),
                              in);
  const auto ours = artnet::decode_dmx(packet);
  const auto theirs = sim::decode_art_dmx(packet);
  LUXRIG_CHECK(ours.has_value() == theirs.has_value(), "ArtDmx of {} bytes: ours {}, the node's {}", packet.size(),
               ours.has_value(), theirs.has_value());
  LUXRIG_CHECK(!ours || (ours->sequence == theirs->sequence && ours->port_address == theirs->port_address &&
                         ours->physical == theirs->physical && same(ours->slots, theirs->slots)),
               "ArtDmx read differently");
  LUXRIG_CHECK(artnet::decode_poll(packet).has_value() == sim::is_art_poll(packet), "ArtPoll of {} bytes",
               packet.size());
  LUXRIG_CHECK(artnet::is_sync(packet) == sim::is_art_sync(packet), "ArtSync of {} bytes", packet.size());
}

void rdm_packet(Input& in) {
  rdm::Packet sent;
  sent.to = rdm::uid_of(std::uint64_t{in.word()} << 32 | in.word() << 16 | in.word());
  sent.from = rdm::uid_of(std::uint64_t{in.word()} << 32 | in.word() << 16 | in.word());
  sent.transaction = in.byte();
  sent.port_or_type = in.byte();
  sent.message_count = in.byte();
  sent.sub_device = static_cast<std::uint16_t>(in.word());
  sent.command_class = static_cast<rdm::CommandClass>(0x10 * (1 + in.byte() % 3) + in.byte() % 2);
  sent.pid = static_cast<rdm::Pid>(in.word());
  sent.data = in.bytes(in.up_to(rdm::kMaxData));
  const Bytes packet = edited(rdm::encode(sent), in);
  const auto ours = rdm::decode(packet);
  const auto theirs = sim::read_rdm(packet);
  LUXRIG_CHECK(ours.has_value() == theirs.has_value(), "RDM of {} bytes: ours {}, the fixture's {}", packet.size(),
               ours.has_value(), theirs.has_value());
  if (ours)
    LUXRIG_CHECK(rdm::number_of(ours->to) == theirs->to && rdm::number_of(ours->from) == theirs->from &&
                     ours->transaction == theirs->transaction && ours->port_or_type == theirs->port_or_type &&
                     ours->message_count == theirs->messages && ours->sub_device == theirs->sub_device &&
                     static_cast<int>(ours->command_class) == theirs->command_class &&
                     static_cast<int>(ours->pid) == theirs->pid && same(ours->data, theirs->data),
                 "RDM read differently");
  const std::uint64_t uid = rdm::number_of(sent.from);
  LUXRIG_CHECK(rdm::decode_branch_answer(sim::write_branch_answer(uid)) == sent.from, "a fixture's branch answer");
}

/// Registers and bits that hold what was written to them.
class Units final : public sim::ModbusUnits {
 public:
  [[nodiscard]] bool has(int unit) const override { return unit != 99; }
  [[nodiscard]] bool has_bits(int) const override { return true; }
  std::optional<sim::ModbusException> read(int unit, sim::RegisterKind kind, int first,
                                           std::span<std::uint16_t> values) override {
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = value(unit, kind, first + static_cast<int>(i));
    return std::nullopt;
  }
  std::optional<sim::ModbusException> write(int unit, int first, std::span<const std::uint16_t> values) override {
    return put(unit, sim::RegisterKind::holding, first, values);
  }
  std::optional<sim::ModbusException> write_coils(int unit, int first, std::span<const std::uint16_t> bits) override {
    return put(unit, sim::RegisterKind::coil, first, bits);
  }
  [[nodiscard]] std::uint16_t value(int unit, sim::RegisterKind kind, int at) const {
    const auto found = written_.find({unit, kind, at});
    if (found != written_.end()) return found->second;
    const bool bit = kind == sim::RegisterKind::coil || kind == sim::RegisterKind::discrete;
    return static_cast<std::uint16_t>((unit * 31 + at * 17) & (bit ? 1 : 0xFFFF));
  }

 private:
  std::optional<sim::ModbusException> put(int unit, sim::RegisterKind kind, int first,
                                          std::span<const std::uint16_t> values) {
    for (std::size_t i = 0; i < values.size(); ++i) written_[{unit, kind, first + static_cast<int>(i)}] = values[i];
    return std::nullopt;
  }
  std::map<std::tuple<int, sim::RegisterKind, int>, std::uint16_t> written_;
};

void modbus_exchange(Input& in) {
  using modbus::Function;
  constexpr Function kFunctions[] = {Function::read_coils,  Function::read_discrete, Function::read_holding,
                                     Function::read_input,  Function::write_coil,    Function::write_single,
                                     Function::write_coils, Function::write_multiple};
  modbus::Request request;
  request.unit = in.byte();
  request.function = kFunctions[in.byte() % 8];
  const bool bits = modbus::is_of_bits(request.function);
  const bool one = request.function == Function::write_coil || request.function == Function::write_single;
  const std::size_t most = modbus::reads(request.function) ? (bits ? modbus::kMaxReadBits : modbus::kMaxReadRegisters)
                           : bits                          ? modbus::kMaxWriteCoils
                                                           : modbus::kMaxWriteRegisters;
  request.count = one ? 1 : 1 + in.up_to(most - 1);
  request.first_register = static_cast<int>(in.up_to(65536 - request.count));
  if (!modbus::reads(request.function))
    for (std::size_t i = 0; i < request.count; ++i)
      request.values.push_back(static_cast<std::uint16_t>(bits ? in.byte() & 1 : in.word()));
  const auto transaction = static_cast<std::uint16_t>(in.word());
  Units units;
  sim::ModbusSession session;
  const auto replies = session.receive(modbus::encode(request, transaction), units);
  LUXRIG_CHECK(replies.size() == 1 && !session.broken(), "{} answers to one request", replies.size());
  const modbus::Answer answer = modbus::decode(request, transaction, replies[0].bytes);
  if (!units.has(request.unit)) {
    LUXRIG_CHECK(answer.verdict == modbus::Verdict::exception, "a unit that is not there: {}", answer.what);
    return;
  }
  LUXRIG_CHECK(answer.verdict == modbus::Verdict::good, "function {}: {}", static_cast<int>(request.function),
               answer.what);
  const sim::RegisterKind kind = request.function == Function::read_discrete ? sim::RegisterKind::discrete
                                 : request.function == Function::read_input  ? sim::RegisterKind::input
                                 : bits                                      ? sim::RegisterKind::coil
                                                                             : sim::RegisterKind::holding;
  const std::vector<std::uint16_t>& moved = modbus::reads(request.function) ? answer.values : request.values;
  LUXRIG_CHECK(moved.size() == request.count, "{} of {} values", moved.size(), request.count);
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const std::uint16_t there = units.value(request.unit, kind, request.first_register + static_cast<int>(i));
    LUXRIG_CHECK(moved[i] == there, "value {}: {} on our side, {} in the unit", i, moved[i], there);
  }
}

void canopen_object(Input& in) {
  constexpr int kNode = 5;
  // Objects of CiA 402 with their sizes; the last is in no dictionary.
  struct Object {
    std::uint16_t index;
    std::uint8_t sub;
    std::size_t bytes;
  };
  constexpr Object kObjects[] = {{0x607A, 0, 4}, {0x607C, 0, 4}, {0x6081, 0, 4}, {0x6083, 0, 4}, {0x6084, 0, 4},
                                 {0x6085, 0, 4}, {0x605A, 0, 2}, {0x6060, 0, 1}, {0x6098, 0, 1}, {0x6099, 1, 4},
                                 {0x6099, 2, 4}, {0x609A, 0, 4}, {0x6066, 0, 2}, {0x607D, 1, 4}, {0x5FFF, 0, 4}};
  const Object& object = kObjects[in.byte() % std::size(kObjects)];
  const canopen::ObjectAddress address{object.index, object.sub};
  const Bytes value = in.bytes(in.byte() % 8 == 0 ? 1 + in.up_to(3) : object.bytes);

  sim::AxisNode node(kNode, {}, 0, 200);
  node.set_power(Time{}, true);
  (void)node.take_sent();
  const auto ask = [&](const canopen::SdoBytes& request) {
    const auto frame = sim::unpacked(can::to_bytes(can::data_frame(0x600 + kNode, request)));
    LUXRIG_CHECK(frame.has_value(), "a frame that the bus does not read");
    node.receive(Time{}, *frame);
    const auto sent = node.take_sent();
    LUXRIG_CHECK(sent.size() == 1 && sent[0].id == 0x580 + kNode, "{} frames for one request", sent.size());
    const auto back = can::from_bytes(sim::packed(sent[0]));
    LUXRIG_CHECK(back.has_value(), "a frame that we do not read");
    return canopen::decode_sdo_answer(back->payload());
  };
  const canopen::SdoAnswer before = ask(canopen::encode_upload(address));
  const canopen::SdoAnswer written = ask(canopen::encode_download(address, value));
  const canopen::SdoAnswer after = ask(canopen::encode_upload(address));
  for (const canopen::SdoAnswer& answer : {before, written, after})
    LUXRIG_CHECK(answer.kind != canopen::SdoAnswerKind::garbled && answer.object == address, "object {}: garbled",
                 canopen::text_of(address));
  const bool exists = object.index != 0x5FFF;
  LUXRIG_CHECK((after.kind == canopen::SdoAnswerKind::uploaded) == exists, "object {}", canopen::text_of(address));
  if (written.kind == canopen::SdoAnswerKind::downloaded)
    LUXRIG_CHECK(same(after.bytes, value), "object {} does not hold what was written", canopen::text_of(address));
  else
    LUXRIG_CHECK(same(after.bytes, before.bytes), "object {} changed though it refused", canopen::text_of(address));
  LUXRIG_CHECK(value.size() == object.bytes || written.kind == canopen::SdoAnswerKind::aborted,
               "object {} took {} bytes", canopen::text_of(address), value.size());
}

void enttec_messages(Input& in) {
  sim::EnttecWidget widget;
  widget.power_on(Time{});
  const auto ask = [&](const Bytes& message) {
    widget.receive(Time{}, {}, {}, message);
    enttec::StreamDecoder decoder;
    decoder.add(widget.take(Time{}, 100000));
    auto answer = decoder.next();
    LUXRIG_CHECK(!decoder.next() && decoder.dropped() == 0, "more than one answer");
    return answer;
  };
  DmxSlots slots{};
  for (std::uint8_t& slot : slots) slot = in.byte();
  LUXRIG_CHECK(!ask(enttec::encode_output(slots)), "an answer to DMX");
  const auto look = widget.line(Time{});
  LUXRIG_CHECK(look && same(*look, slots) && widget.dropped() == 0, "other slots on the line");
  enttec::Parameters wanted;
  wanted.break_units = 9 + in.byte() % 119;
  wanted.mark_units = 1 + in.byte() % 127;
  wanted.rate_hz = in.byte() % 41;
  LUXRIG_CHECK(!ask(enttec::encode_set_parameters(wanted)), "an answer to new parameters");
  const std::uint8_t none[] = {0, 0};
  const auto answer = ask(enttec::encode(enttec::Label::get_parameters, none));
  LUXRIG_CHECK(answer.has_value(), "no parameters");
  const auto there = enttec::decode_parameters(answer->data);
  LUXRIG_CHECK(there && there->break_units == wanted.break_units && there->mark_units == wanted.mark_units &&
                   there->rate_hz == wanted.rate_hz,
               "other parameters than were set");
}

}  // namespace
}  // namespace luxrig

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace luxrig;
  if (size == 0) return 0;
  constexpr void (*kWires[])(Input&) = {sacn_data,       sacn_sync,      artnet_packet,  rdm_packet,
                                        modbus_exchange, canopen_object, enttec_messages};
  Input in(data + 1, size - 1);
  kWires[data[0] % std::size(kWires)](in);
  return 0;
}
