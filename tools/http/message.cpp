#include "tools/http/message.h"

#include <arpa/inet.h>

#include <algorithm>
#include <array>
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

/// "name", "name:port" or "[address]:port" without the port; empty if it is none of them.
std::string_view without_port(std::string_view host) {
  const std::size_t bracket = host.substr(0, 1) == "[" ? host.find(']') : 0;
  if (bracket == std::string_view::npos) return "";
  const std::size_t colon = host.find(':', bracket);
  if (colon == std::string_view::npos) return host;
  const std::string_view port = host.substr(colon + 1);
  const bool is_port = !port.empty() && port.size() <= 5 &&
                       std::all_of(port.begin(), port.end(), [](char c) { return c >= '0' && c <= '9'; });
  return is_port ? host.substr(0, colon) : "";
}

/// In the form of inet_ntop(); empty if it is none.
std::string address_in(std::string_view text) {
  std::array<unsigned char, 16> bytes{};
  std::array<char, INET6_ADDRSTRLEN> out{};
  const std::string whole(text);
  for (const int family : {AF_INET, AF_INET6})
    if (::inet_pton(family, whole.c_str(), bytes.data()) == 1)
      return ::inet_ntop(family, bytes.data(), out.data(), out.size()) ? out.data() : "";
  return "";
}

bool is_our_name(std::string_view host, const HttpNames& names) {
  const std::string_view name = without_port(host);
  if (name.empty()) return false;
  if (name == "127.0.0.1" || name == "localhost" || name == "[::1]") return true;
  const bool bracketed = name.front() == '[' && name.back() == ']';
  const std::string address = address_in(bracketed ? name.substr(1, name.size() - 2) : name);
  if (!address.empty() && (names.any_address || address == names.listens_at)) return true;
  return std::any_of(names.of_certificate.begin(), names.of_certificate.end(), [&](const std::string& known) {
    if (known.substr(0, 2) != "*.") return name == known || (!address.empty() && address == known);
    const std::size_t dot = name.find('.');
    return dot != 0 && dot != std::string_view::npos && name.substr(dot) == std::string_view(known).substr(1);
  });
}

bool is_loopback_address(const std::string& address) {
  return address == "::1" || (address.rfind("127.", 0) == 0 && address_in(address) == address);
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

void hear_proxy(HttpRequest& request) {
  std::optional<std::string_view> said;
  for (const auto& [name, value] : request.headers)
    if (name == "x-forwarded-for") said = value;  // some proxies add a header, others to the client's
  if (!said || !is_loopback_address(request.from)) return;
  request.proxied = true;
  std::string_view last = said->substr(said->rfind(',') + 1);  // npos + 1 is 0
  last.remove_prefix(std::min(last.size(), last.find_first_not_of(' ')));
  if (const std::string address = address_in(last); !address.empty()) request.from = address;
  request.secure = request.header("x-forwarded-proto") == "https";
  if (const auto host = request.header("x-forwarded-host")) {
    const std::string named(*host);
    for (auto& [name, value] : request.headers)
      if (name == "host") value = named;
  }
}

std::optional<HttpResponse> foreign_request(const HttpRequest& request, bool has_body, const HttpNames& names) {
  std::vector<std::string> hosts, types;
  for (const auto& [name, value] : request.headers) {
    if (name == "host") hosts.push_back(small_letters(value));
    if (name == "content-type") types.push_back(small_letters(value));
  }
  if (hosts.size() != 1 || (!request.proxied && !is_our_name(hosts[0], names)))
    return http_refusal(403, names.any_address
                                 ? "not reachable by this name: use a name that its certificate has, or its address"
                                 : "only reachable by its loopback address");
  const std::string origin = (request.secure ? "https://" : "http://") + hosts[0];
  for (const auto& [name, value] : request.headers) {
    if (name == "origin" && small_letters(value) != origin) return http_refusal(403, "refused from another origin");
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
