// Frame times of the web viewer on WebGL 2: frustum culling against visibility, on one path around the scene.
// usage: node viewer.mjs FRAMES FILE...

import { basename } from 'node:path';
import { median, openPage, shown } from './page.mjs';

const [frames, ...files] = process.argv.slice(2);

/** The round trip of `svs evaluate`: twice near (1.05 radii) and far (3), up and down. @param {number[]} bounds @param {number} count */
function path(bounds, count) {
    const [low, high] = [bounds.slice(0, 3), bounds.slice(3)];
    const center = low.map((value, axis) => (value + high[axis]) / 2);
    const radius = Math.hypot(...low.map((value, axis) => high[axis] - value)) / 2;
    return Array.from({ length: count }, (_, index) => {
        const angle = (2 * Math.PI * index) / count;
        const distance = radius * (1.05 + 1.95 * (0.5 + 0.5 * Math.cos(2 * angle)));
        const elevation = ((20 + 30 * Math.sin(3 * angle)) * Math.PI) / 180;
        const outward = [Math.cos(angle) * Math.cos(elevation), Math.sin(elevation), Math.sin(angle) * Math.cos(elevation)];
        return {
            eye: center.map((value, axis) => value + outward[axis] * distance),
            forward: outward.map((value) => -value),
            fov: Math.PI / 3,
            near: radius * 0.01,
        };
    });
}

for (const file of files) {
    const { page, source, close } = await openPage(file);
    await page.evaluate((source) => /** @type {any} */ (window).svs.openUrl(`${source}`), source);
    await shown(page);
    const bounds = await page.evaluate(() => [.../** @type {any} */ (window).svs.viewer.bounds()]);
    const poses = path(bounds, Number(frames));
    /** @type {Record<string, any>} */
    const row = { scene: basename(file).replace(/(\.svs)?\.glb$/, '') };
    for (const method of ['frustum', 'visibility']) {
        const measured = await page.evaluate(async ([method, poses]) => {
            const { svs } = /** @type {any} */ (window);
            svs.viewer.set_method(method);
            svs.viewer.set_continuous(true);
            const results = [];
            for (const pose of /** @type {any[]} */ (poses)) {
                svs.setCamera(pose);
                // The browser is a frame or two ahead of what draws: the third tells how long one takes.
                const times = [];
                for (let frame = 0; frame < 4; frame += 1) {
                    await new Promise(requestAnimationFrame);
                    times.push(JSON.parse(svs.viewer.figures()).frameMs);
                }
                const figures = JSON.parse(svs.viewer.figures());
                results.push({ ms: Math.max(...times.slice(2)), triangles: figures.triangles, cull: figures.cullUs, draws: figures.draws });
            }
            svs.viewer.set_continuous(false);
            return results;
        }, /** @type {const} */ ([method, poses]));
        row[method] = {
            ms: median(measured.map(({ ms }) => ms)),
            triangles: median(measured.map(({ triangles }) => triangles)),
            draws: median(measured.map(({ draws }) => draws)),
            cullUs: median(measured.map(({ cull }) => cull)),
        };
    }
    console.log(JSON.stringify(row));
    await close();
}
