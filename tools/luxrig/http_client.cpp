#include "tools/luxrig/http_client.h"

#include <httplib.h>

namespace luxrig {
namespace {

httplib::Client client_of(const std::string& host, int port) {
  httplib::Client client(host, port);
  client.set_connection_timeout(2);
  client.set_read_timeout(5);
  return client;
}

std::optional<HttpAnswer> answer_of(const httplib::Result& result) {
  if (!result) return {};
  return HttpAnswer{result->status, result->body};
}

}  // namespace

std::optional<HttpAnswer> http_get(const std::string& host, int port, const std::string& route) {
  return answer_of(client_of(host, port).Get(route));
}

std::optional<HttpAnswer> http_post_json(const std::string& host, int port, const std::string& route,
                                         const std::string& body) {
  return answer_of(client_of(host, port).Post(route, body, "application/json"));
}

}  // namespace luxrig
