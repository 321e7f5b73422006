#include "tools/http/client.h"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/beast/core/basic_stream.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>
#include <chrono>

namespace luxrig {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;

constexpr std::chrono::seconds kConnect{2};
constexpr std::size_t kMaxAnswerBytes = 256u << 20;  // a camera's picture in floats

template <class Protocol>
std::optional<HttpAnswer> exchange(const typename Protocol::endpoint& endpoint,
                                   const http::request<http::string_body>& request, int wait_s) {
  asio::io_context io{1};
  beast::basic_stream<Protocol> stream(io);
  beast::flat_buffer buffer;
  http::response_parser<http::string_body> parser;
  parser.body_limit(kMaxAnswerBytes);
  boost::system::error_code failed = asio::error::would_block;
  // Only asynchronous calls have a deadline.
  stream.expires_after(kConnect);
  stream.async_connect(endpoint, [&](boost::system::error_code error) {
    failed = error;
    if (error) return;
    stream.expires_after(std::chrono::seconds(wait_s));
    http::async_write(stream, request, [&](boost::system::error_code, std::size_t) {
      // A server that refuses may close before everything is written. Its answer says why.
      http::async_read(stream, buffer, parser, [&](boost::system::error_code read, std::size_t) { failed = read; });
    });
  });
  io.run();
  if (failed) return std::nullopt;
  return HttpAnswer{static_cast<int>(parser.get().result_int()), std::move(parser.get().body())};
}

std::optional<HttpAnswer> ask(const HttpPeer& peer, http::request<http::string_body> request, int wait_s) {
  request.set(http::field::host, "localhost");
  request.set(http::field::connection, "close");
  if (!peer.token.empty()) request.set(http::field::authorization, "Bearer " + peer.token);
  request.prepare_payload();
  if (!peer.socket.empty())
    return exchange<asio::local::stream_protocol>(asio::local::stream_protocol::endpoint(peer.socket), request, wait_s);
  boost::system::error_code error;
  const auto address = asio::ip::make_address(peer.host == "localhost" ? "127.0.0.1" : peer.host, error);
  if (error) return std::nullopt;
  return exchange<asio::ip::tcp>({address, static_cast<unsigned short>(peer.port)}, request, wait_s);
}

}  // namespace

bool http_listens(const std::string& socket) {
  asio::io_context io{1};
  asio::local::stream_protocol::socket probe(io);
  boost::system::error_code error;
  probe.connect(asio::local::stream_protocol::endpoint(socket), error);
  return !error;
}

std::optional<HttpAnswer> http_get(const HttpPeer& peer, const std::string& route, int wait_s) {
  return ask(peer, {http::verb::get, route, 11}, wait_s);
}

std::optional<HttpAnswer> http_post_json(const HttpPeer& peer, const std::string& route, const std::string& body,
                                         int wait_s) {
  http::request<http::string_body> request{http::verb::post, route, 11};
  request.set(http::field::content_type, "application/json");
  request.body() = body;
  return ask(peer, std::move(request), wait_s);
}

}  // namespace luxrig
