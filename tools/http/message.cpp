#include "tools/http/message.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "tools/http/percent.h"

namespace luxrig {
namespace {

constexpr std::uintmax_t kMaxFileBytes = 16u << 20;

std::string small_letters(std::string_view text) {
  std::string small(text);
  std::transform(small.begin(), small.end(), small.begin(), [](unsigned char c) { return std::tolower(c); });
  return small;
}

/// "name" or "name:port" of this machine's loopback.
bool is_loopback_host(std::string_view host) {
  for (const std::string_view name : {"127.0.0.1", "localhost", "[::1]"}) {
    if (host.substr(0, name.size()) != name) continue;
    const std::string_view rest = host.substr(name.size());
    if (rest.empty()) return true;
    if (rest[0] == ':' && rest.size() >= 2 && rest.size() <= 6 &&
        std::all_of(rest.begin() + 1, rest.end(), [](char c) { return c >= '0' && c <= '9'; }))
      return true;
  }
  return false;
}

std::string content_type_of(const std::filesystem::path& file) {
  constexpr std::pair<std::string_view, const char*> kTypes[] = {{".html", "text/html; charset=utf-8"},
                                                                 {".js", "text/javascript"},
                                                                 {".css", "text/css"},
                                                                 {".svg", "image/svg+xml"},
                                                                 {".png", "image/png"},
                                                                 {".ico", "image/vnd.microsoft.icon"},
                                                                 {".json", "application/json"},
                                                                 {".txt", "text/plain; charset=utf-8"},
                                                                 {".woff2", "font/woff2"}};
  const std::string extension = file.extension().string();
  for (const auto& [known, type] : kTypes)
    if (extension == known) return type;
  return "application/octet-stream";
}

}  // namespace

std::optional<std::string_view> HttpRequest::header(std::string_view name) const {
  for (const auto& [known, value] : headers)
    if (known == name) return value;
  return std::nullopt;
}

std::optional<std::string> HttpRequest::parameter(std::string_view name) const {
  for (std::string_view rest = query; !rest.empty();) {
    const std::string_view pair = rest.substr(0, rest.find('&'));
    rest.remove_prefix(std::min(rest.size(), pair.size() + 1));
    const std::size_t equals = pair.find('=');
    if (pair.substr(0, equals) != name) continue;
    return percent_decoded(equals == std::string_view::npos ? std::string_view() : pair.substr(equals + 1), true);
  }
  return std::nullopt;
}

bool path_is_of(std::string_view path, std::string_view route) {
  const std::size_t brace = route.find('{');
  if (brace == std::string_view::npos) return path == route;
  return path.size() > brace && path.substr(0, brace) == route.substr(0, brace) &&
         path.find('/', brace) == std::string_view::npos;
}

std::string_view last_part(std::string_view path) { return path.substr(path.rfind('/') + 1); }

HttpResponse http_refusal(int status, const std::string& what) {
  return {status, "application/json",
          nlohmann::json{{"error", what}}.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)};
}

HttpResponse static_file(const std::string& folder, std::string_view path) {
  const HttpResponse none = http_refusal(404, "there is no such page");
  const std::string inside(path == "/" ? "/index.html" : path);
  // File names of a built page need no other letters. So no path leads out of the folder.
  const bool plain = std::all_of(inside.begin(), inside.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '/' || c == '.' || c == '-' || c == '_';
  });
  if (!plain || inside.empty() || inside[0] != '/' || inside.find("/.") != std::string::npos) return none;
  const std::filesystem::path file = folder + inside;
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error) || std::filesystem::file_size(file, error) > kMaxFileBytes)
    return none;
  std::ifstream in(file, std::ios::binary);
  HttpResponse response{200, content_type_of(file), {std::istreambuf_iterator<char>(in), {}}};
  if (!in) return none;
  return response;
}

std::optional<HttpResponse> foreign_request(const HttpRequest& request, bool has_body) {
  std::vector<std::string> hosts, types;
  for (const auto& [name, value] : request.headers) {
    if (name == "host") hosts.push_back(small_letters(value));
    if (name == "content-type") types.push_back(small_letters(value));
  }
  if (hosts.size() != 1 || !is_loopback_host(hosts[0]))
    return http_refusal(403, "only reachable by its loopback address");
  for (const auto& [name, value] : request.headers) {
    if (name == "origin" && small_letters(value) != "http://" + hosts[0])
      return http_refusal(403, "refused from another origin");
    // Another port of loopback is the same site, but another program.
    if (name == "sec-fetch-site" && value != "same-origin" && value != "none")
      return http_refusal(403, "refused from another site: type the address, or open it from the terminal");
  }
  if (has_body) {
    const std::string type = types.size() == 1 ? types[0].substr(0, types[0].find(';')) : "";
    if (type.substr(0, type.find_last_not_of(" \t") + 1) != "application/json")
      return http_refusal(415, "send it with Content-Type: application/json");
  }
  return std::nullopt;
}

}  // namespace luxrig
