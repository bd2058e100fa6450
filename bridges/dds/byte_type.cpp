#include "bridges/dds/byte_type.h"

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>
#include <dds/ddsi/q_radmin.h>

#include <algorithm>
#include <cstring>

#include "base/bytes.h"
#include "bridges/dds.h"

namespace sf::bridges {

namespace {

struct Sample : ddsi_serdata {
  base::Bytes bytes;  ///< a multiple of 4, as on the network
  std::uint32_t size = 0;
};

Sample* new_sample(const ddsi_sertype* type, ddsi_serdata_kind kind, std::size_t size) {
  auto* sample = new Sample;
  ddsi_serdata_init(sample, type, kind);
  sample->size = static_cast<std::uint32_t>(size);
  sample->bytes.resize((size + 3) / 4 * 4, 0);
  return sample;
}

const Sample* sample_of(const ddsi_serdata* data) { return static_cast<const Sample*>(data); }

// Received from the network. Fragments may overlap. An oversized sample becomes empty, which readers reject.
ddsi_serdata* from_fragments(const ddsi_sertype* type, ddsi_serdata_kind kind, const nn_rdata* fragment,
                             std::size_t size) {
  if (size > kDdsMaxReceived) return new_sample(type, kind, 0);
  Sample* sample = new_sample(type, kind, size);
  for (std::uint32_t done = 0; fragment != nullptr; fragment = fragment->nextfrag) {
    if (fragment->maxp1 <= done) continue;
    const auto end = std::min<std::uint32_t>(fragment->maxp1, sample->size);
    if (end <= done) break;
    const auto* payload = NN_RMSG_PAYLOADOFF(fragment->rmsg, NN_RDATA_PAYLOAD_OFF(fragment));
    std::memcpy(sample->bytes.data() + done, payload + (done - fragment->min), end - done);
    done = end;
  }
  return sample;
}

ddsi_serdata* from_parts(const ddsi_sertype* type, ddsi_serdata_kind kind, ddsrt_msg_iovlen_t count,
                         const ddsrt_iovec_t* parts, std::size_t size) {
  Sample* sample = new_sample(type, kind, size);
  std::size_t done = 0;
  for (ddsrt_msg_iovlen_t i = 0; i < count && done < size; ++i) {
    const std::size_t more = std::min<std::size_t>(parts[i].iov_len, size - done);
    std::memcpy(sample->bytes.data() + done, parts[i].iov_base, more);
    done += more;
  }
  return sample;
}

void copy_out(const ddsi_serdata* data, std::size_t offset, std::size_t size, void* out) {
  std::memcpy(out, sample_of(data)->bytes.data() + offset, size);
}

ddsi_serdata* lend(const ddsi_serdata* data, std::size_t offset, std::size_t size, ddsrt_iovec_t* part) {
  part->iov_base = const_cast<std::uint8_t*>(sample_of(data)->bytes.data()) + offset;
  part->iov_len = static_cast<ddsrt_iov_len_t>(size);
  return ddsi_serdata_ref(data);
}

ddsi_serdata* without_type(const ddsi_serdata* data) {
  Sample* sample = new_sample(data->type, SDK_KEY, 0);
  sample->type = nullptr;
  return sample;
}

std::size_t print(const ddsi_sertype*, const ddsi_serdata* data, char* text, std::size_t size) {
  return static_cast<std::size_t>(std::snprintf(text, size, "%u bytes", sample_of(data)->size));
}

// Without a key, all samples belong to one instance. Samples are exchanged only as bytes, by dds_forwardcdr and
// dds_takecdr.
ddsi_serdata_ops sample_functions() {
  ddsi_serdata_ops functions{};
  functions.eqkey = [](const ddsi_serdata*, const ddsi_serdata*) { return true; };
  functions.get_size = [](const ddsi_serdata* data) { return sample_of(data)->size; };
  functions.from_ser = from_fragments;
  functions.from_ser_iov = from_parts;
  functions.from_keyhash = [](const ddsi_sertype* type, const ddsi_keyhash*) -> ddsi_serdata* {
    return new_sample(type, SDK_KEY, 0);
  };
  functions.from_sample = [](const ddsi_sertype* type, ddsi_serdata_kind kind, const void*) -> ddsi_serdata* {
    return new_sample(type, kind, 0);
  };
  functions.to_ser = copy_out;
  functions.to_ser_ref = lend;
  functions.to_ser_unref = [](ddsi_serdata* data, const ddsrt_iovec_t*) { ddsi_serdata_unref(data); };
  functions.to_sample = [](const ddsi_serdata*, void*, void**, void*) { return false; };
  functions.to_untyped = without_type;
  functions.untyped_to_sample = [](const ddsi_sertype*, const ddsi_serdata*, void*, void**, void*) { return true; };
  functions.free = [](ddsi_serdata* data) { delete static_cast<Sample*>(data); };
  functions.print = print;
  functions.get_keyhash = [](const ddsi_serdata*, ddsi_keyhash* hash, bool) { std::memset(hash, 0, sizeof(*hash)); };
#ifdef DDS_HAS_SHM  // shared memory, which is not used for types of variable size
  functions.get_sample_size = ddsi_serdata_iox_size;
  functions.from_iox_buffer = [](const ddsi_sertype*, ddsi_serdata_kind, void*, void*) -> ddsi_serdata* {
    return nullptr;
  };
#endif
  return functions;
}

ddsi_sertype_ops type_functions() {
  ddsi_sertype_ops functions{};
  functions.version = ddsi_sertype_v0;
  functions.free = [](ddsi_sertype* type) {
    ddsi_sertype_fini(type);
    delete type;
  };
  functions.zero_samples = [](const ddsi_sertype*, void*, std::size_t) {};
  functions.realloc_samples = [](void**, const ddsi_sertype*, void*, std::size_t, std::size_t) {};
  functions.free_samples = [](const ddsi_sertype*, void**, std::size_t, dds_free_op_t) {};
  functions.equal = [](const ddsi_sertype*, const ddsi_sertype*) { return true; };
  functions.hash = [](const ddsi_sertype*) { return 0U; };
  return functions;
}

}  // namespace

ddsi_sertype* new_byte_type(const char* name) {
  static const ddsi_serdata_ops samples = sample_functions();
  static const ddsi_sertype_ops types = type_functions();
  auto* type = new ddsi_sertype{};
  ddsi_sertype_init(type, name, &types, &samples, true);
  type->allowed_data_representation = DDS_DATA_REPRESENTATION_FLAG_XCDR1;
  return type;
}

ddsi_serdata* new_byte_sample(const ddsi_sertype* type, std::span<const std::uint8_t> message) {
  Sample* sample = new_sample(type, SDK_DATA, message.size());
  std::memcpy(sample->bytes.data(), message.data(), message.size());
  sample->timestamp.v = dds_time();
  return sample;
}

std::span<const std::uint8_t> bytes_of(const ddsi_serdata* sample) {
  return std::span(sample_of(sample)->bytes).first(sample_of(sample)->size);
}

}  // namespace sf::bridges
