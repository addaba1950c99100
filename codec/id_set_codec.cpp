#include "codec/id_set_codec.h"

#include <algorithm>
#include <array>

#include "codec/id_set_delimiter.h"
#include "codec/id_set_rivals.h"

namespace promenade {
namespace {

constexpr std::array<IdSetCodec, 10> kCodecs = {{
    {"raw", "four bytes an id", encode_raw, decode_raw},
    {"delimiter", "[chhugani2003] delimiter code of the gaps", encode_delimiter_ids, decode_delimiter_ids},
    {"delimiter-runs", "[chhugani2003] delimiter code of (gap, run)", encode_delimiter_runs, decode_delimiter_runs},
    {"adaptive-huffman", "(gap, run) by adaptive Huffman codes", encode_huffman, decode_huffman},
    {"paper", "[chhugani2003] the shorter of the last two", encode_paper, decode_paper},
    {"varint", "(gap, run), seven bits a byte", encode_varint, decode_varint},
    {"rice", "(gap, run) by Golomb-Rice codes", encode_rice, decode_rice},
    {"elias-fano", "low bits plain, high bits unary", encode_elias_fano, decode_elias_fano},
    {"roaring", "CRoaring's portable format with runs", encode_roaring, decode_roaring},
    {"zstd", "zstd level 19 over varint", encode_zstd, decode_zstd},
}};

}  // namespace

std::span<const IdSetCodec> id_set_codecs() { return kCodecs; }

const IdSetCodec* find_id_set_codec(std::string_view name) {
  const auto* found =
      std::find_if(kCodecs.begin(), kCodecs.end(), [name](const IdSetCodec& c) { return c.name == name; });
  return found == kCodecs.end() ? nullptr : found;
}

}  // namespace promenade
