#include "drivers/modbus/modbus_contact.h"

#include <fmt/format.h>

namespace luxrig::modbus {

std::optional<ContactPatch> contact_patch(const Bus& bus, std::span<const OptionDoc> docs) {
  const std::int64_t input = integer_option(bus, docs, kContactInputOption.key);
  if (input < 0) return std::nullopt;
  return ContactPatch{static_cast<int>(integer_option(bus, docs, kContactUnitOption.key)), static_cast<int>(input),
                      string_option(bus, docs, kContactWhenOption.key) == "open"};
}

std::vector<Problem> check_contact(const Rig& rig, const Bus& bus, std::span<const OptionDoc> docs, int first_unit,
                                   int last_unit) {
  std::vector<Problem> problems;
  const std::string when = string_option(bus, docs, kContactWhenOption.key);
  if (when != "open" && when != "closed")
    problems.push_back(problem_at(rig, bus, kContactWhenOption.key, fmt::format("blackout_when cannot be \"{}\"", when),
                                  "choose open or closed"));
  const std::int64_t unit = integer_option(bus, docs, kContactUnitOption.key);
  if (unit < first_unit || unit > last_unit)
    problems.push_back(problem_at(rig, bus, kContactUnitOption.key, fmt::format("no unit has the number {}", unit),
                                  fmt::format("give one from {} to {}", first_unit, last_unit)));
  const bool without = !bus.options.contains(std::string(kContactInputOption.key));
  for (const OptionDoc& of_it : {kContactUnitOption, kContactWhenOption})
    if (without && bus.options.contains(std::string(of_it.key)))
      problems.push_back(problem_at(rig, bus, of_it.key, fmt::format("{} says nothing without blackout_input", of_it.key),
                                    "say which input it is: blackout_input = 0"));
  return problems;
}

std::optional<Request> ContactWatch::due(Time now) const {
  if (asked_ && now - *asked_ < kEvery) return std::nullopt;
  return Request{patch_.unit, Function::read_discrete, patch_.input, 1, {}};
}

void ContactWatch::answered(Time now, bool closed) {
  answered_ = now;
  closed_ = closed;
}

Contact ContactWatch::contact(Time now) const {
  if (!answered_ || now - *answered_ > kKnownFor) return Contact::unknown;
  return closed_ == patch_.when_open ? Contact::rests : Contact::pressed;
}

}  // namespace luxrig::modbus
