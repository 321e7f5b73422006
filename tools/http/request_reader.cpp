#include "tools/http/request_reader.h"

#include <algorithm>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>
#include <cctype>
#include <cstdint>
#include <limits>

namespace luxrig {
namespace {

namespace http = boost::beast::http;
constexpr std::size_t kMaxHeadBytes = 8192;
constexpr std::size_t kMaxHeaders = 64;
// The C library keeps freed blocks of up to 32 MiB for reuse. A body that may be large gets a larger block: only the
// written part takes memory, and the block is returned to the system.
constexpr std::size_t kKeptBytes = 1u << 20, kNeverKeptBytes = 33u << 20;
constexpr std::size_t kLastChunkBytes = 5;  // "0\r\n\r\n"
constexpr const char* kHeadTooLong = "the request line and headers are longer than 8 KiB";
constexpr const char* kBodyTooLong = "the body is too long";

}  // namespace

struct RequestReader::Parser {
  http::request_parser<http::string_body> beast;
  std::string pending;  ///< not parsed yet
  std::size_t head_bytes = 0;
};

RequestReader::RequestReader() : parser_(std::make_unique<Parser>()) {
  parser_->beast.header_limit(kMaxHeadBytes);
  parser_->beast.body_limit(std::numeric_limits<std::uint64_t>::max());  // accept_body() sets the limit
}
RequestReader::~RequestReader() = default;

void RequestReader::refuse(int status, const char* what) {
  at_ = At::refused;
  refusal_ = http_refusal(status, what);
  parser_->pending = {};
}

void RequestReader::put(std::string_view bytes) {
  if (bytes.empty() || (at_ != At::head && at_ != At::body)) return;
  begun_ = true;
  parser_->pending.append(bytes);
  parse();
}

void RequestReader::parse() {
  auto& beast = parser_->beast;
  auto& pending = parser_->pending;
  std::size_t used = 0;
  while (used < pending.size() && !beast.is_done()) {
    // Beast 1.74 asserts when given a last chunk of fewer bytes. No chunked body ends in fewer.
    if (at_ == At::body && beast.chunked() && pending.size() - used < kLastChunkBytes) break;
    boost::system::error_code error;
    used += beast.put(boost::asio::const_buffer(pending.data() + used, pending.size() - used), error);
    if (error == http::error::need_more) break;
    if (error == http::error::header_limit) return refuse(431, kHeadTooLong);
    if (error == http::error::body_limit) return refuse(413, kBodyTooLong);
    if (error) return refuse(400, "this is no valid HTTP request");
    if (at_ == At::head && beast.is_header_done()) {
      parser_->head_bytes += used;
      pending.erase(0, used);
      return parser_->head_bytes > kMaxHeadBytes ? refuse(431, kHeadTooLong) : read_head();
    }
  }
  pending.erase(0, used);
  if (at_ == At::head) parser_->head_bytes += used;
  if (beast.is_done()) {
    at_ = At::whole;
    request_.body = std::move(beast.get().body());
  } else if (pending.size() > kMaxHeadBytes) {
    // Beast has no limit for chunk extensions and trailers.
    refuse(431, kHeadTooLong);
  }
}

void RequestReader::read_head() {
  const auto& head = parser_->beast.get();
  const std::string_view target(head.target().data(), head.target().size());
  request_.method = std::string(head.method_string());
  const std::size_t question = target.find('?');
  request_.path = std::string(target.substr(0, question));
  if (question != std::string_view::npos) request_.query = std::string(target.substr(question + 1));
  for (const auto& field : head) {
    std::string name(field.name_string());
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
    request_.headers.emplace_back(std::move(name), std::string(field.value()));
  }
  if (request_.headers.size() > kMaxHeaders) return refuse(431, "more than 64 headers");
  if (request_.path.empty() || request_.path[0] != '/') return refuse(400, "ask for a path that begins with /");
  at_ = At::decision;
}

void RequestReader::accept_body(std::size_t max_bytes) {
  if (at_ != At::decision) return;
  if (!parser_->beast.chunked() && longest_body_bytes() > max_bytes) return refuse(413, kBodyTooLong);
  parser_->beast.body_limit(max_bytes);
  parser_->beast.eager(true);
  if (std::min<std::uint64_t>(max_bytes, longest_body_bytes()) >= kKeptBytes)
    parser_->beast.get().body().reserve(kNeverKeptBytes);
  at_ = At::body;
  parse();
}

bool RequestReader::has_body() const { return longest_body_bytes() > 0; }
std::uint64_t RequestReader::longest_body_bytes() const {
  if (parser_->beast.chunked()) return std::numeric_limits<std::uint64_t>::max();
  return parser_->beast.content_length().value_or(0);
}
bool RequestReader::more_came() const { return !parser_->pending.empty(); }
bool RequestReader::keep_alive() const { return parser_->beast.keep_alive(); }

}  // namespace luxrig
