// Any bytes as a request from the network: never a throw, never more than the limits, and no handler gets a request
// meant for another.
#include <cmath>
#include <cstdint>
#include <string>

#include "core/check.h"
#include "core/plan/plan.h"
#include "tools/http/json_body.h"
#include "tools/http/request_reader.h"
#include "tools/luxrigd/api/access.h"
#include "tools/luxrigd/api/preview_json.h"
#include "tools/luxrigd/api/route_table.h"

namespace {

using luxrig::RequestReader;

luxrig::HttpHandlers checking_handlers() {
  luxrig::HttpHandlers handlers;
  handlers.session = handlers.login =
      handlers.logout = [](const luxrig::HttpRequest&) { return luxrig::HttpResponse{}; };
  handlers.one_time_address = handlers.status = handlers.universes =
      handlers.room_json = [] { return std::string("{}"); };
  handlers.changes = [](const std::string&) { return std::string("{}"); };
  handlers.rig = [] {
    static const auto kept = std::make_shared<const luxrig::KeptAnswer>(luxrig::kept_answer("text/plain", "{}"));
    return kept;
  };
  handlers.start_job = [](const std::string&) { return luxrig::Result<std::string>("00000000-000001"); };
  handlers.jobs = [] { return std::vector<luxrig::Job>(); };
  handlers.job = handlers.cancel_job = [](const std::string&) { return std::optional<luxrig::Job>(); };
  handlers.room_png = [] { return std::string(); };
  handlers.scene = [](const luxrig::HttpRequest&) { return luxrig::HttpResponse{}; };
  handlers.blackout = [](bool) { return luxrig::Result<void>(); };
  handlers.identify = [](const std::string&, double seconds) {
    LUXRIG_CHECK(seconds > 0 && seconds <= 60, "identify for {} s", seconds);
    return luxrig::Result<void>();
  };
  handlers.aim = [](const std::string&, const luxrig::Joints& joints, double level, double seconds) {
    LUXRIG_CHECK(!std::isnan(joints.pan_rad + joints.tilt_rad + level), "{} {}", joints.pan_rad, level);
    LUXRIG_CHECK(seconds > 0 && seconds <= 60, "an aim for {} s", seconds);
    return luxrig::Result<void>();
  };
  handlers.preview = [](const luxrig::PreviewQuestion& question, const std::string&) {
    LUXRIG_CHECK(!question.changes.empty() && question.changes.size() <= luxrig::kMaxChanges, "{} changes",
                 question.changes.size());
    return luxrig::Result<std::string>("{}");
  };
  handlers.park = [](const std::vector<std::string>&) { return luxrig::Result<void>(); };
  handlers.hand_back = [] {};
  handlers.plan = [] { return std::string("{}"); };
  handlers.apply = [](const std::string& plan, std::optional<double> fade_s) -> luxrig::Checked<std::string> {
    LUXRIG_CHECK(!fade_s || (*fade_s >= 0.1 && *fade_s <= 600), "fades in {} s", *fade_s);
    if (const auto read = luxrig::plan_from_json(plan, "plan"); !read) return tl::unexpected(read.error());
    return std::string("applied");
  };
  handlers.level = [](const std::vector<std::string>& names, double value, const luxrig::ByHandTimes& times) {
    LUXRIG_CHECK(!names.empty() && !std::isnan(value), "{} names, {}", names.size(), value);
    LUXRIG_CHECK(!times.for_s || (*times.for_s > 0 && *times.for_s <= 366 * 86400.0), "held for {} s", *times.for_s);
    LUXRIG_CHECK(!times.fade_s || (*times.fade_s >= 0.1 && *times.fade_s <= 600), "fades in {} s", *times.fade_s);
    return luxrig::Result<std::string>("held");
  };
  handlers.goal = handlers.level;
  handlers.levels = [](const std::vector<std::pair<std::string, double>>& levels, const luxrig::ByHandTimes& times) {
    LUXRIG_CHECK(!levels.empty(), "no levels");
    LUXRIG_CHECK(!times.fade_s || (*times.fade_s >= 0.1 && *times.fade_s <= 600), "fades in {} s", *times.fade_s);
    return luxrig::Result<std::string>("held");
  };
  handlers.release = [](const std::vector<std::string>&, std::optional<double>) {
    return luxrig::Result<std::string>("released");
  };
  handlers.bypass = [](const std::vector<std::string>&, bool) { return luxrig::Result<std::string>("bypassed"); };
  handlers.question = [](const luxrig::HandQuestion& question, double seconds) {
    LUXRIG_CHECK(!question.id.empty() && question.text.size() <= 4 * 400, "a question of {}", question.text.size());
    LUXRIG_CHECK(question.position_world_m.allFinite() && std::abs(question.normal_world.norm() - 1) < 1e-9,
                 "it has no place");
    LUXRIG_CHECK(question.level >= 0 && question.level <= 1 && question.step <= question.steps, "level {}",
                 question.level);
    LUXRIG_CHECK(seconds > 0 && seconds <= 600, "asked for {} s", seconds);
    return std::optional<luxrig::HandAnswer>();
  };
  handlers.withdraw_question = [](const std::string&) {};
  handlers.answer = [](const std::string&, const luxrig::HandAnswer& answer) {
    LUXRIG_CHECK(answer.lux >= 0 && answer.lux <= luxrig::kMostLux, "{} lx", answer.lux);
    return luxrig::Result<void>();
  };
  handlers.reload = [] { return luxrig::Checked<std::string>("reloaded"); };
  return handlers;
}

/// The server's answer to bytes that arrive in parts: its status; 0 = waits for more.
int status_of(std::string_view bytes, std::size_t part, const std::vector<luxrig::HttpRoute>& routes) {
  static luxrig::Access access;
  RequestReader reader;
  const luxrig::HttpRoute* route = nullptr;
  for (std::size_t at = 0; at < bytes.size(); at += part) {
    reader.put(bytes.substr(at, part));
    if (reader.at() == RequestReader::At::decision) {
      const luxrig::HttpRequest& request = reader.request();
      LUXRIG_CHECK(!request.path.empty() && request.path[0] == '/', "path {}", request.path);
      LUXRIG_CHECK(access.sender(request).rank == 0, "somebody has guessed the token");
      if (const auto refusal = luxrig::foreign_request(request, reader.has_body())) return refusal->status;
      (void)request.parameter("open");
      for (const luxrig::HttpRoute& one : routes)
        if (luxrig::path_is_of(request.path, one.path) && one.method == request.method) route = &one;
      if (!route) return luxrig::static_file("/nonexistent", request.path).status;
      reader.accept_body(route->max_body_bytes);
    }
    if (reader.at() == RequestReader::At::refused) return reader.refusal().status;
    if (reader.at() == RequestReader::At::whole) break;
  }
  if (reader.at() != RequestReader::At::whole) return 0;
  LUXRIG_CHECK(reader.request().body.size() <= route->max_body_bytes, "a body of {}", reader.request().body.size());
  return route->handle(reader.request()).status;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::vector<luxrig::HttpRoute> routes = luxrig::http_routes(checking_handlers());
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const int whole = status_of(bytes, std::max<std::size_t>(size, 1), routes);
  LUXRIG_CHECK(whole == 0 || (whole >= 200 && whole < 600), "status {}", whole);
  // Bytes one by one are accepted exactly when they are at once; of bad requests, one way may still wait for more.
  const int bit_by_bit = status_of(bytes, 1, routes);
  const auto taken = [](int status) { return status >= 200 && status < 300; };
  LUXRIG_CHECK(taken(whole) == taken(bit_by_bit), "{} at once, {} byte by byte", whole, bit_by_bit);
  // The body alone, without the head.
  for (const luxrig::HttpRoute& route : routes) {
    luxrig::HttpRequest request;
    request.body = std::string(bytes);
    if (route.method == "POST") (void)route.handle(request);
  }
  return 0;
}
