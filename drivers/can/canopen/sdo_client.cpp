#include "drivers/can/canopen/sdo_client.h"

#include <utility>

#include "core/check.h"
#include "drivers/can/canopen/cob_id.h"

namespace luxrig::canopen {
namespace {

SdoBytes first_bytes(const SdoRequest& request) {
  return request.value.empty() ? encode_upload(request.object) : encode_download(request.object, request.value);
}

}  // namespace

can::CanFrame SdoClient::frame_of(const SdoBytes& bytes) const {
  return can::data_frame(kSdoToServer + static_cast<std::uint32_t>(node_), bytes);
}

void SdoClient::start(SdoRequest request) {
  LUXRIG_CHECK(idle(), "a transfer of {} is under way", text_of(request_->object));
  request_ = std::move(request);
  result_.reset();
  due_ = first_bytes(*request_);
  tries_ = 0;
  in_segments_ = false;
}

std::optional<can::CanFrame> SdoClient::to_send(Time now) {
  if (parting_) return frame_of(*std::exchange(parting_, std::nullopt));
  if (!request_) return std::nullopt;
  if (!due_ && now - sent_ >= kAnswerTimeout) {
    if (tries_ > kRetries) {
      const ObjectAddress object = request_->object;
      end(tl::unexpected(SdoFailure{}));
      parting_ = encode_abort(object, kAbortTimeout);
      return frame_of(*std::exchange(parting_, std::nullopt));
    }
    in_segments_ = false;
    due_ = first_bytes(*request_);
  }
  if (!due_) return std::nullopt;
  if (!in_segments_) ++tries_;
  sent_ = now;
  return frame_of(*std::exchange(due_, std::nullopt));
}

void SdoClient::receive(const can::CanFrame& frame) {
  if (!request_ || tries_ == 0) return;
  const SdoAnswer answer = decode_sdo_answer(frame.payload());
  if (answer.kind == SdoAnswerKind::segment) {
    if (in_segments_ && !due_) take_segment(answer);
    return;
  }
  if (answer.kind == SdoAnswerKind::garbled || answer.object != request_->object) return;
  const bool reads = request_->value.empty();
  switch (answer.kind) {
    case SdoAnswerKind::aborted:
      end(tl::unexpected(SdoFailure{answer.abort_code}));
      return;
    case SdoAnswerKind::downloaded:
      if (!reads) end(std::vector<std::uint8_t>{});
      return;
    case SdoAnswerKind::uploaded:
      if (reads && !in_segments_) end(answer.bytes);
      return;
    case SdoAnswerKind::started:
      if (!reads || in_segments_) return;
      in_segments_ = true;
      toggle_ = false;
      read_.clear();
      due_ = encode_upload_segment(toggle_);
      return;
    default:
      return;
  }
}

void SdoClient::take_segment(const SdoAnswer& answer) {
  if (answer.toggle != toggle_) {
    parting_ = encode_abort(request_->object, kAbortToggle);
    end(tl::unexpected(SdoFailure{kAbortToggle}));
    return;
  }
  if (read_.size() + answer.bytes.size() > kLongestValue) {
    parting_ = encode_abort(request_->object, kAbortOutOfMemory);
    end(tl::unexpected(SdoFailure{kAbortOutOfMemory}));
    return;
  }
  read_.insert(read_.end(), answer.bytes.begin(), answer.bytes.end());
  if (answer.last) {
    end(std::exchange(read_, {}));
    return;
  }
  toggle_ = !toggle_;
  due_ = encode_upload_segment(toggle_);
}

void SdoClient::end(SdoResult result) {
  request_.reset();
  due_.reset();
  result_ = std::move(result);
}

std::optional<SdoResult> SdoClient::take_result() { return std::exchange(result_, std::nullopt); }

}  // namespace luxrig::canopen
