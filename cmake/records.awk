# Writes GLSL for a header of records that host and device share: an include of the header, and for each struct S in it
#   struct S { ... };
#   S decode_S(uvec4 t0, ...)    from its texels     load_S(table, row)        from a table of texels
#   uvec4[n] encode_S(S r)       to its texels       store_S(table, row, r)    to a table of texels
# With -v layouts=1, writes a C++ source instead, which compares the offset of each field with the compiler's.
#
# A record is a whole number of texels of 16 bytes, or two words in a table of words. Arrays have four elements and become
# vectors in GLSL. A field whose type is a record is one texel.

BEGIN {
  split("float std::uint32_t std::int32_t double std::uint16_t", names)
  split("float uint int double uint", glsl_names)
  for (i in names) glsl[names[i]] = glsl_names[i]
  read["float"] = "uintBitsToFloat(@)"; read["uint"] = "@"; read["int"] = "int(@)"; read["double"] = "packDouble2x32(@)"
  put["float"] = "floatBitsToUint(@)"; put["uint"] = "@"; put["int"] = "uint(@)"; put["double"] = "unpackDouble2x32(@)"
  vector["float"] = "vec4"; vector["uint"] = "uvec4"; vector["int"] = "ivec4"; vector["double"] = "dvec4"
}

function fail(why) {
  print FILENAME ":" FNR ": " why > "/dev/stderr"
  exit failed = 1
}

# The next `count` words of the record, as components of a texel.
function words(count,   part) {
  if (at % 4 + count > 4) fail(record ": a field crosses the end of a texel; expected each field within 16 bytes")
  part = "t" int(at / 4) "." substr("xyzw", at % 4 + 1, count)
  at += count
  return part
}

function with(pattern, value) { sub(/@/, value, pattern); return pattern }

function add_read(value) { reads = reads (reads == "" ? "" : ", ") value }

# Texels begin at words whose index is a multiple of four.
function add_put(value, from) { puts = puts (puts == "" ? "uvec4(" : from % 4 == 0 ? "), uvec4(" : ", ") value }

function add_field(cpp, name,   type, from, i) {
  array = sub(/\[.*/, "", name)
  checks = checks "static_assert(offsetof(" space "::" record ", " name ") == " 4 * at ");\n"
  if (cpp in texels) {
    if (texels[cpp] != 1 || at % 4 != 0) fail(record "::" name " does not start a texel; expected a record of one texel at a multiple of 16 bytes")
    type = cpp
    add_read("decode_" cpp "(t" at / 4 ")")
    add_put("encode_" cpp "(r." name ")[0]", at)
    at += 4
  } else if (cpp == "std::uint16_t" && array) {
    type = "uvec4"
    from = at
    i = words(2)
    add_read("uvec4(" i ", " i ").xzyw >> uvec4(0u, 16u, 0u, 16u) & 0xFFFFu")
    add_put("r." name ".xz | r." name ".yw << 16", from)
  } else if (cpp in glsl) {
    type = array ? vector[glsl[cpp]] : glsl[cpp]
    if (array) add_read(type "(")
    for (i = 1; i <= (array ? 4 : 1); ++i) {
      from = at
      value = with(read[glsl[cpp]], words(glsl[cpp] == "double" ? 2 : 1))
      if (array) reads = reads (i > 1 ? ", " : "") value; else add_read(value)
      add_put(with(put[glsl[cpp]], "r." name (array ? "." substr("xyzw", i, 1) : "")), from)
    }
    if (array) reads = reads ")"
  } else {
    fail("type " cpp " has no counterpart; expected float, double, std::uint32_t, std::int32_t, four std::uint16_t or a record above")
  }
  fields = fields "  " type " " name ";\n"
}

function end_record(   n, i, list, loads, stores) {
  if (at != 2 && at % 4 != 0) fail(record " has " 4 * at " bytes; expected 8 or a multiple of 16")
  checks = checks "static_assert(sizeof(" space "::" record ") == " 4 * at ");\n"
  n = at == 2 ? 1 : at / 4
  texels[record] = at / 4
  for (i = 0; i < n; ++i) {
    list = list (i ? ", " : "") (at == 2 ? "uvec2" : "uvec4") " t" i
    loads = loads (i ? ", " : "") "imageLoad(table, " n " * (row) + " i ")"
    stores = stores " imageStore(table, " n " * (row) + " i ", texels_[" i "]);"
  }
  if (at == 2) loads = "uvec2(imageLoad(table, 2 * (row)).x, imageLoad(table, 2 * (row) + 1).x)"
  if (layouts) return
  print "\nstruct " record " {\n" fields "};\n" record " decode_" record "(" list ") { return " record "(" reads "); }"
  print "#define load_" record "(table, row) decode_" record "(" loads ")"
  if (at == 2) return
  print "uvec4[" n "] encode_" record "(" record " r) { return uvec4[" n "](" puts ")); }"
  print "#define store_" record "(table, row, r) { const uvec4 texels_[" n "] = encode_" record "(r);" stores " }"
}

FNR == 1 && !layouts { print "// Written from " FILENAME ".\n#include \"" FILENAME "\"" }
FNR == 1 && layouts { print "// Written from " FILENAME ".\n#include \"" FILENAME "\"\n\n#include <cstddef>\n" }
{ sub(/\/\/.*/, "") }
/^namespace / { space = $2 }
/^struct .* {/ { record = $2; at = 0; fields = reads = puts = ""; next }
record != "" && /^};/ { end_record(); record = "" }
record != "" && NF > 0 {
  cpp = $1
  sub(/^ *[^ ]+ /, "")
  sub(/;.*/, "")
  n = split($0, list, ",")
  for (k = 1; k <= n; ++k) {
    sub(/=.*/, "", list[k])
    gsub(/ /, "", list[k])
    add_field(cpp, list[k])
  }
}
END { if (!failed && layouts) printf "%s", checks }
