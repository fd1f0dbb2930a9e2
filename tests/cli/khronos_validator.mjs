// Runs the Khronos glTF validator: node khronos_validator.mjs NPM_FOLDER FILE...
// Prints a JSON array with one { file, errors, warnings, messages } per file; messages are errors and warnings only.
import { createRequire } from 'node:module';
import { readFile } from 'node:fs/promises';
import { dirname, join, resolve } from 'node:path';

const [folder, ...files] = process.argv.slice(2);
const validator = createRequire(join(resolve(folder), 'package.json'))('gltf-validator');

const reports = [];
for (const file of files) {
  const report = await validator.validateBytes(new Uint8Array(await readFile(file)), {
    uri: file,
    // 0 = all messages: with a limit the counts stop at it.
    maxIssues: 0,
    externalResourceFunction: async (uri) =>
      new Uint8Array(await readFile(join(dirname(file), decodeURIComponent(uri)))),
  });
  reports.push({
    file,
    errors: report.issues.numErrors,
    warnings: report.issues.numWarnings,
    messages: report.issues.messages.filter((message) => message.severity < 2).slice(0, 20),
  });
}
process.stdout.write(JSON.stringify(reports));
