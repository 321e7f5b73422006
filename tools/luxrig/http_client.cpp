#include "tools/luxrig/http_client.h"

#include <httplib.h>

namespace luxrig {
namespace {

httplib::Client client_of(const std::string& host, int port, int wait_s) {
  httplib::Client client(host, port);
  client.set_connection_timeout(2);
  client.set_read_timeout(wait_s);
  return client;
}

std::optional<HttpAnswer> answer_of(const httplib::Result& result) {
  if (!result) return {};
  return HttpAnswer{result->status, result->body};
}

}  // namespace

std::optional<HttpAnswer> http_get(const std::string& host, int port, const std::string& route, int wait_s) {
  return answer_of(client_of(host, port, wait_s).Get(route));
}

std::optional<HttpAnswer> http_post_json(const std::string& host, int port, const std::string& route,
                                         const std::string& body, int wait_s) {
  return answer_of(client_of(host, port, wait_s).Post(route, body, "application/json"));
}

}  // namespace luxrig
