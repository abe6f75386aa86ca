//! Taking `RELUME_transfer` out of a document again, so that baking a baked file replaces its transfer.

use std::collections::BTreeSet;

use serde_json::{Map, Value};

use super::header::NAME;

/// What the extension calls its buffer views.
const ARRAYS: &[&str] = &[
    "transfer", "matrices", "valid", "vertices", "counts", "columns", "weights", "table",
];

/// Removes the extension from every node, the document and `extensionsUsed`, and its buffer views where they are the last ones and nothing else names
/// them. Returns how many of the `length` bytes of the buffer are still wanted.
pub fn strip(json: &mut Value, length: usize) -> usize {
    let mut views = BTreeSet::new();
    if let Some(nodes) = json.get_mut("nodes").and_then(Value::as_array_mut) {
        for node in nodes.iter_mut().filter_map(Value::as_object_mut) {
            if let Some(extension) = take(node) {
                collect(&extension, ARRAYS, &mut views);
            }
        }
    }
    if let Some(extension) = json.as_object_mut().and_then(take) {
        collect(&extension, ARRAYS, &mut views);
    }
    forget_use(json);
    let mut others = BTreeSet::new();
    collect(json, &["bufferView"], &mut others);
    let wanted = |i: usize| others.contains(&i) || !views.contains(&i);
    let length = match json.get_mut("bufferViews").and_then(Value::as_array_mut) {
        Some(array) => drop_tail(array, wanted, length),
        None => length,
    };
    remove_empty(json, &["bufferViews"]);
    length
}

/// [`strip`] for a document whose transfer lies in a file of its own, which then is not referred to any more. Others stay as they are.
pub fn strip_beside(json: &mut Value) {
    let nodes = json["nodes"].as_array().into_iter().flatten();
    let mut extensions = nodes.map(|node| &node["extensions"][NAME]);
    if !extensions.any(|extension| extension.get("bin").is_some()) {
        return;
    }
    strip(json, usize::MAX);
    let mut views = json["bufferViews"].as_array().into_iter().flatten();
    let used = views.any(|view| view["buffer"] == 1);
    if let Some(buffers) = json.get_mut("buffers").and_then(Value::as_array_mut)
        && buffers.len() == 2
        && !used
    {
        buffers.pop();
    }
}

/// Takes the extension out of a node or the document, and `extensions` when it is empty then.
fn take(node: &mut Map<String, Value>) -> Option<Value> {
    let extensions = node.get_mut("extensions")?.as_object_mut()?;
    let taken = extensions.shift_remove(NAME)?;
    if extensions.is_empty() {
        node.shift_remove("extensions");
    }
    Some(taken)
}

fn forget_use(json: &mut Value) {
    let used = json.get_mut("extensionsUsed").and_then(Value::as_array_mut);
    if let Some(used) = used {
        let before = used.len();
        used.retain(|name| name != NAME);
        if used.len() < before {
            remove_empty(json, &["extensionsUsed"]);
        }
    }
}

fn remove_empty(json: &mut Value, keys: &[&str]) {
    if let Some(object) = json.as_object_mut() {
        for key in keys {
            let array = object.get(*key).and_then(Value::as_array);
            if array.is_some_and(Vec::is_empty) {
                object.shift_remove(*key);
            }
        }
    }
}

/// Every whole number that stands under one of `keys`, however deep.
fn collect(value: &Value, keys: &[&str], found: &mut BTreeSet<usize>) {
    match value {
        Value::Object(object) => {
            for (key, value) in object {
                let index = value.as_u64().and_then(|i| usize::try_from(i).ok());
                match index {
                    Some(index) if keys.contains(&key.as_str()) => {
                        found.insert(index);
                    }
                    _ => collect(value, keys, found),
                }
            }
        }
        Value::Array(array) => array.iter().for_each(|value| collect(value, keys, found)),
        _ => {}
    }
}

/// Removes unwanted views from the end, and the bytes behind the last that stays if those views were all there was.
fn drop_tail(views: &mut Vec<Value>, wanted: impl Fn(usize) -> bool, length: usize) -> usize {
    let number = |view: &Value, key: &str| view.get(key).and_then(Value::as_u64).unwrap_or(0);
    let inside = |view: &Value| number(view, "buffer") == 0;
    let mut first = length as u64;
    while let Some(last) = views.last()
        && !wanted(views.len() - 1)
    {
        if inside(last) {
            first = first.min(number(last, "byteOffset"));
        }
        views.pop();
    }
    let end = |view: &Value| number(view, "byteOffset").saturating_add(number(view, "byteLength"));
    let needed = views
        .iter()
        .filter(|view| inside(view))
        .map(end)
        .max()
        .unwrap_or(0);
    if needed <= first {
        first as usize
    } else {
        length
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn baked() -> Value {
        json!({
            "extensionsUsed": ["KHR_lights_punctual", NAME],
            "nodes": [
                { "mesh": 0, "extensions": { NAME: { "primitives": [{ "transfer": 1, "valid": 2 }] } } },
                { "extensions": { "KHR_lights_punctual": { "light": 0 }, NAME: { "primitives": [
                    { "transfer": 3, "back": { "count": 1, "vertices": 4, "transfer": 5 } }] } } },
            ],
            "accessors": [{ "bufferView": 0 }],
            "bufferViews": [
                { "byteLength": 8 },
                { "byteOffset": 8, "byteLength": 4 }, { "byteOffset": 12, "byteLength": 1 },
                { "byteOffset": 16, "byteLength": 4 }, { "byteOffset": 20, "byteLength": 4 },
                { "byteOffset": 24, "byteLength": 4 },
            ],
        })
    }

    #[test]
    fn nothing_of_the_transfer_stays() {
        let mut json = baked();
        assert_eq!(strip(&mut json, 28), 8);
        let expected = json!({
            "extensionsUsed": ["KHR_lights_punctual"],
            "nodes": [{ "mesh": 0 }, { "extensions": { "KHR_lights_punctual": { "light": 0 } } }],
            "accessors": [{ "bufferView": 0 }],
            "bufferViews": [{ "byteLength": 8 }],
        });
        assert_eq!(json, expected);
        assert_eq!(strip(&mut json, 8), 8);
        assert_eq!(json, expected);
    }

    #[test]
    fn views_that_others_use_stay_where_they_are() {
        let mut json = baked();
        json["images"] = json!([{ "bufferView": 4 }]);
        assert_eq!(strip(&mut json, 28), 24);
        assert_eq!(json["bufferViews"].as_array().map(Vec::len), Some(5));
        let mut interleaved = baked();
        interleaved["bufferViews"][0]["byteLength"] = 26.into();
        assert_eq!(strip(&mut interleaved, 28), 28);
    }
}
