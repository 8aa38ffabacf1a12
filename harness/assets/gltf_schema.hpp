#pragma once

namespace clothbench::assets::gltf {

/// Types of all values of a glTF 2.0 file that the readers use. tinygltf leaves out a value of another type.
inline constexpr char kSchema[] = R"({
  "definitions": {
    "text": {"type": "string"},
    "index": {"type": "integer", "minimum": 0},
    "indices": {"type": "array", "items": {"$ref": "#/definitions/index"}},
    "index_by_name": {"type": "object", "additionalProperties": {"$ref": "#/definitions/index"}},
    "numbers": {"type": "array", "items": {"type": "number"}},
    "numbers3": {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3},
    "numbers4": {"type": "array", "items": {"type": "number"}, "minItems": 4, "maxItems": 4},
    "numbers16": {"type": "array", "items": {"type": "number"}, "minItems": 16, "maxItems": 16},
    "primitive": {"type": "object", "required": ["attributes"], "properties": {
      "attributes": {"$ref": "#/definitions/index_by_name"},
      "targets": {"type": "array", "items": {"$ref": "#/definitions/index_by_name"}},
      "indices": {"$ref": "#/definitions/index"},
      "material": {"$ref": "#/definitions/index"},
      "mode": {"$ref": "#/definitions/index"}}}
  },
  "type": "object", "required": ["asset"], "properties": {
    "asset": {"type": "object", "required": ["version"], "properties": {
      "version": {"$ref": "#/definitions/text"},
      "minVersion": {"$ref": "#/definitions/text"}}},
    "extensionsUsed": {"type": "array", "items": {"$ref": "#/definitions/text"}},
    "extensionsRequired": {"type": "array", "items": {"$ref": "#/definitions/text"}},
    "scene": {"$ref": "#/definitions/index"},
    "scenes": {"type": "array", "items": {"type": "object", "properties": {"nodes": {"$ref": "#/definitions/indices"}}}},
    "nodes": {"type": "array", "items": {"type": "object", "properties": {
      "name": {"$ref": "#/definitions/text"},
      "children": {"$ref": "#/definitions/indices"},
      "mesh": {"$ref": "#/definitions/index"},
      "skin": {"$ref": "#/definitions/index"},
      "matrix": {"$ref": "#/definitions/numbers16"},
      "translation": {"$ref": "#/definitions/numbers3"},
      "rotation": {"$ref": "#/definitions/numbers4"},
      "scale": {"$ref": "#/definitions/numbers3"},
      "weights": {"$ref": "#/definitions/numbers"}}}},
    "meshes": {"type": "array", "items": {"type": "object", "required": ["primitives"], "properties": {
      "name": {"$ref": "#/definitions/text"},
      "weights": {"$ref": "#/definitions/numbers"},
      "primitives": {"type": "array", "items": {"$ref": "#/definitions/primitive"}}}}},
    "materials": {"type": "array", "items": {"type": "object", "properties": {"name": {"$ref": "#/definitions/text"}}}},
    "skins": {"type": "array", "items": {"type": "object", "required": ["joints"], "properties": {
      "inverseBindMatrices": {"$ref": "#/definitions/index"},
      "joints": {"$ref": "#/definitions/indices"}}}},
    "accessors": {"type": "array", "items": {"type": "object", "required": ["componentType", "count", "type"], "properties": {
      "bufferView": {"$ref": "#/definitions/index"},
      "byteOffset": {"$ref": "#/definitions/index"},
      "componentType": {"$ref": "#/definitions/index"},
      "normalized": {"type": "boolean"},
      "count": {"$ref": "#/definitions/index"},
      "type": {"$ref": "#/definitions/text"},
      "sparse": {"type": "object"}}}},
    "bufferViews": {"type": "array", "items": {"type": "object", "required": ["buffer", "byteLength"], "properties": {
      "buffer": {"$ref": "#/definitions/index"},
      "byteOffset": {"$ref": "#/definitions/index"},
      "byteLength": {"$ref": "#/definitions/index"},
      "byteStride": {"$ref": "#/definitions/index"}}}},
    "buffers": {"type": "array", "items": {"type": "object", "required": ["byteLength"], "properties": {
      "byteLength": {"$ref": "#/definitions/index"},
      "uri": {"$ref": "#/definitions/text"}}}}
  }
})";

}  // namespace clothbench::assets::gltf
