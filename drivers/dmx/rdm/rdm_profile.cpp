#include "drivers/dmx/rdm/rdm_profile.h"

#include <algorithm>

namespace luxrig::rdm {
namespace {

constexpr int kMaxSensors = 16;

/// Asks one device; `gone` holds the fault of a device or line that no longer answers.
struct Reader {
  const Ask& ask;
  Uid uid;
  std::optional<Fault> gone{};

  std::optional<std::vector<std::uint8_t>> get(Pid pid, std::vector<std::uint8_t> data = {}) {
    if (gone) return std::nullopt;
    Request request;
    request.to = uid;
    request.pid = pid;
    request.data = std::move(data);
    auto answer = ask(request);
    if (answer) return std::move(*answer);
    if (answer.error().cause != Cause::refused && answer.error().cause != Cause::protocol) gone = answer.error();
    return std::nullopt;
  }

  std::string label(Pid pid) {
    const auto data = get(pid);
    return data ? decode_label(*data).value_or("") : std::string();
  }
};

}  // namespace

Result<DeviceProfile> read_profile(const Ask& ask, const Uid& uid) {
  Request first;
  first.to = uid;
  const auto info_data = ask(first);
  if (!info_data) return tl::unexpected(info_data.error());
  const auto info = decode_device_info(*info_data);
  if (!info) {
    return tl::unexpected(Fault{
        Cause::protocol, text_of(uid), "its device_info breaks the standard: " + describe(first.pid, *info_data), {}});
  }
  DeviceProfile profile;
  profile.uid = uid;
  profile.info = *info;
  Reader reader{ask, uid};
  // The few that every device must have need not be in the list.
  const auto listed = reader.get(Pid::supported_parameters);
  const auto pids = decode_supported_parameters(listed.value_or(std::vector<std::uint8_t>{}));
  const auto has = [&pids](Pid pid) { return pids && std::find(pids->begin(), pids->end(), pid) != pids->end(); };
  profile.software = reader.label(Pid::software_version_label);
  if (has(Pid::manufacturer_label)) profile.manufacturer = reader.label(Pid::manufacturer_label);
  if (has(Pid::device_model_description)) profile.model = reader.label(Pid::device_model_description);
  if (has(Pid::device_label)) profile.label = reader.label(Pid::device_label);
  if (has(Pid::dmx_personality_description) && info->personality > 0) {
    const auto data = reader.get(Pid::dmx_personality_description, {static_cast<std::uint8_t>(info->personality)});
    if (data) profile.personality = decode_personality_description(*data);
  }
  if (has(Pid::slot_info)) {
    if (const auto data = reader.get(Pid::slot_info)) {
      profile.slots = decode_slot_info(*data).value_or(std::vector<SlotInfo>{});
    }
  }
  if (has(Pid::lamp_hours)) {
    if (const auto data = reader.get(Pid::lamp_hours)) profile.lamp_hours = decode_hours(*data);
  }
  if (has(Pid::device_hours)) {
    if (const auto data = reader.get(Pid::device_hours)) profile.device_hours = decode_hours(*data);
  }
  if (has(Pid::lamp_state)) {
    if (const auto data = reader.get(Pid::lamp_state)) profile.lamp = decode_lamp_state(*data);
  }
  for (int i = 0; has(Pid::sensor_definition) && i < std::min(info->sensors, kMaxSensors); ++i) {
    const auto number = static_cast<std::uint8_t>(i);
    const auto data = reader.get(Pid::sensor_definition, {number});
    const auto definition = data ? decode_sensor_definition(*data) : std::nullopt;
    if (!definition) continue;
    SensorState sensor{*definition, {}};
    if (const auto value = reader.get(Pid::sensor_value, {number})) sensor.value = decode_sensor_value(*value);
    profile.sensors.push_back(std::move(sensor));
  }
  if (reader.gone) return tl::unexpected(*reader.gone);
  return profile;
}

}  // namespace luxrig::rdm
