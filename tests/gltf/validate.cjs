// node validate.cjs FOLDER FILE...: what the Khronos validator, installed below FOLDER, says of binary glTF files.
const { readFileSync } = require("fs");
const { resolve } = require("path");
const [folder, ...files] = process.argv.slice(2);
const validator = require(resolve(folder, "node_modules", "gltf-validator"));
Promise.all(files.map((file) => validator.validateBytes(new Uint8Array(readFileSync(file)))))
  .then((reports) => console.log(JSON.stringify(reports.map((report) => report.issues))));
